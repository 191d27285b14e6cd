/* log_row.h -- the entries of the logs as rows, listed and walked along. */
#ifndef DB_LOG_ROW_H
#define DB_LOG_ROW_H
#include "log_walk.h"

struct sql_rows; /* sql.h */
struct sql_txn;

#define LOG_ROW_ACCESS "seq, at, kind, actor, uid, object, outcome, hash, mac"
#define LOG_ROW_CHANGE LOG_ROW_ACCESS ", digest, access_seq, access_hash, signature"

/* log_row_read(r, log, out): the current row of these columns; false: damaged, and out->seq is
 * its number, 0 where that is damaged too.
 * log_row_add(t, entry, e): a new row, complete. */
bool log_row_read(const struct sql_rows *r, enum log_name log, struct log_entry *out);
enum status log_row_add(struct sql_txn *t, const struct log_entry *entry,
                        struct errinfo *e);

/* Nothing of them is verified.  ST_ECORRUPT: one cannot be read.
 * log_rows(t, log, newest, from, out, e): the rows behind the number `from`, in their order; or with
 * newest those before it, the last first (0: from the end).  Both logs may be open at once.
 * log_rows_next(r, log, out, there, e): of those rows; *there is false after the last.
 * log_list(t, kind, after, out, n, e): the changes of a kind (NULL: of any) behind that number;
 * released by free().
 * log_walk_all(t, w, e): both logs, of a walk that has begun. */
enum status log_rows(struct sql_txn *t, enum log_name log, bool newest, uint64_t from,
                     struct sql_rows **out, struct errinfo *e);
enum status log_rows_next(struct sql_rows *r, enum log_name log, struct log_entry *out,
                          bool *there, struct errinfo *e);
enum status log_list(struct sql_txn *t, const char *kind, uint64_t after,
                     struct log_entry **out, size_t *n, struct errinfo *e);
enum status log_walk_all(struct sql_txn *t, struct log_walk *w, struct errinfo *e);

#endif
