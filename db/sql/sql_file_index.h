/* sql_file_index.h -- verification of a file's schema and indexes.  An attacker who can write the file can
 * hide a row from an index. */
#ifndef DB_SQL_FILE_INDEX_H
#define DB_SQL_FILE_INDEX_H
#include "sql.h"

/* sql_file_index_check(t, report, arg, problems, e): Verifies that the schema is this program's, and that each
 * index of a table with MACs has the rows of its table and no others, in their order, a unique index
 * each key once.  Calls report() once for each problem.  Ends at the first table with a problem.
 * On a server does nothing.
 * Cost: 2 us for each row: reads each table and each index once, in its order; constant memory. */
enum status sql_file_index_check(struct sql_txn *t, sql_report *report, void *arg,
                                 uint64_t *problems, struct errinfo *e);

#endif
