/* log_list.h -- entries of a log, and a walk along both. */
#ifndef DB_LOG_LIST_H
#define DB_LOG_LIST_H
#include "log_txn.h"
#include "log_walk.h"

/* log_list(t, log, f, out, n, e): in their order; released by free().  Nothing of them is verified.
 * ST_ECORRUPT: one cannot be read.
 * log_walk_all(t, w, e): both logs, of a walk that has begun. */
enum status log_list(struct log_txn *t, enum log_name log, const struct log_filter *f,
                     struct log_entry **out, size_t *n, struct errinfo *e);
enum status log_walk_all(struct log_txn *t, struct log_walk *w, struct errinfo *e);

#endif
