/* rows_digest.h -- all rows with a MAC, verified against the digest of the last change. */
#ifndef DB_ROWS_DIGEST_H
#define DB_ROWS_DIGEST_H
#include "rows_table.h"
#include "rows_types.h"

#define ROWS_TABLES 5
extern const struct rows_table *const rows_tables[ROWS_TABLES]; /* the tables with MACs */

/* rows_digest(t, clear, report, arg, sum, problems, e): Reads every row of these tables once, verifies its MAC,
 * and adds its summand to *sum.  Calls report() (NULL is allowed) once for each row without its MAC.
 *   clear     deletes these rows without an entry, a subject with all that it has.  No index needs to be
 *             good
 *   sum       receives the sum of the authentic rows (log_txn_sum())
 *   problems  receives the number of the others
 * Cost: 2 us for each row; constant memory.
 * ST_ECORRUPT: a table cannot be read in the order of its keys. */
enum status rows_digest(struct log_txn *t, bool clear, store_report *report, void *arg,
                        unsigned char sum[LOG_DIGEST], uint64_t *problems,
                        struct errinfo *e);

/* The problem if the sum is not the digest of the last change. */
extern const char rows_digest_problem[];

/* rows_digest_twice(t, report, arg, problems, e): Finds two rows that share a value which must be unique, an id
 * for example.  The indexes must be good.  Calls report() once for each problem. */
enum status rows_digest_twice(struct log_txn *t, store_report *report, void *arg,
                              uint64_t *problems, struct errinfo *e);

/* rows_digest_orphans(t, report, arg, removed, e): Deletes, without an entry, the templates whose subject is
 * missing.  The indexes must be good.  Calls report() if there are any. */
enum status rows_digest_orphans(struct log_txn *t, store_report *report, void *arg,
                                uint64_t *removed, struct errinfo *e);

#endif
