/* sql_file_index.h -- does a file's schema say what this program's says, and do its indexes say what
 * its tables say?  Somebody who writes the file can hide a row from an index. */
#ifndef DB_SQL_FILE_INDEX_H
#define DB_SQL_FILE_INDEX_H
#include <stdint.h>
#include "status.h"

struct errinfo;
struct sql_txn;

/* sql_file_index_check(t, report, arg, problems, e): is the schema this program's, and has each index
 * of a table with MACs the rows of its table, and no others, in their order, a unique one each key
 * once?  report() is called once a problem with a line of text; it ends with the first table that
 * has one.  Each table and each index is read once, in its order: 2 microseconds a row; memory
 * constant.  On a server it does nothing.  Errors as in sql.h. */
enum status sql_file_index_check(struct sql_txn *t,
                                 void (*report)(void *arg, const char *line), void *arg,
                                 uint64_t *problems, struct errinfo *e);

#endif
