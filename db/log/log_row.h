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

/* log_list(t, log, f, out, n, e): in their order; released by free().  Nothing of them is verified.
 * ST_ECORRUPT: one cannot be read.
 * log_walk_all(t, w, e): both logs, of a walk that has begun. */
enum status log_list(struct sql_txn *t, enum log_name log, const struct log_filter *f,
                     struct log_entry **out, size_t *n, struct errinfo *e);
enum status log_walk_all(struct sql_txn *t, struct log_walk *w, struct errinfo *e);

#endif
