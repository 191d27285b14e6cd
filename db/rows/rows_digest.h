/* rows_digest.h -- all rows with a MAC, against the digest of the last change. */
#ifndef DB_ROWS_DIGEST_H
#define DB_ROWS_DIGEST_H
#include "log_txn.h"

/* rows_digest(t, report, arg, sum, problems, e): every row of every table with a MAC is read once,
 * its MAC verified, and its summand added to *sum; report() (or NULL) is called once a row that has
 * not its MAC, with a line of text.  Memory constant; some 2 microseconds
 * a row.  ST_ECORRUPT: a table cannot be read in the order of its keys.
 * rows_digest_twice(t, report, arg, problems, e): have two rows what only one may have, an id for
 * example?  After the indexes were verified.
 * rows_digest_problem: what to say where the sum is not the last change's. */
enum status rows_digest(struct log_txn *t, void (*report)(void *arg, const char *line),
                        void *arg, unsigned char sum[LOG_DIGEST], uint64_t *problems,
                        struct errinfo *e);
enum status rows_digest_twice(struct log_txn *t,
                              void (*report)(void *arg, const char *line), void *arg,
                              uint64_t *problems, struct errinfo *e);
extern const char rows_digest_problem[];

/* Both delete without an entry, report() it, and say how many; no index is good before the first,
 * every one before the second.
 * rows_digest_clear(t, report, arg, removed, e): rows that have not their MAC, subjects with all
 * that they have.
 * rows_digest_orphans(t, report, arg, removed, e): templates whose subject is not there. */
enum status rows_digest_clear(struct log_txn *t,
                              void (*report)(void *arg, const char *line), void *arg,
                              uint64_t *removed, struct errinfo *e);
enum status rows_digest_orphans(struct log_txn *t,
                                void (*report)(void *arg, const char *line), void *arg,
                                uint64_t *removed, struct errinfo *e);

#endif
