/* log_row.h -- the entries of the logs as rows, listed and walked along. */
#ifndef DB_LOG_ROW_H
#define DB_LOG_ROW_H
#include "log_walk.h"

struct sql_rows; /* sql.h */
struct sql_txn;

#define LOG_ROW_ACCESS "daemon, seq, at, kind, actor, uid, object, outcome, hash, mac"
#define LOG_ROW_CHANGE LOG_ROW_ACCESS ", digest, access_seq, access_hash, signature"

/* log_row_read(r, log, out): the current row of these columns; false: damaged, and out->seq is
 * its number, 0 where that is damaged too.
 * log_row_add(t, entry, e): a new row, complete. */
bool log_row_read(const struct sql_rows *r, enum log_name log, struct log_entry *out);
enum status log_row_add(struct sql_txn *t, const struct log_entry *entry,
                        struct errinfo *e);

struct log_place {
    enum log_name log;
    uint32_t daemon; /* of accesses */
    bool newest;     /* what is before it, the last first, and not what is behind */
    uint64_t seq;    /* of an entry; 0: the beginning, with newest the end */
};

/* Nothing of them is verified.  ST_ECORRUPT: one cannot be read.
 * log_daemons(t, n, e): the number of access logs that have entries, and those before.
 * log_page(t, at, limit, out, n, e): the entries from a place on, at most `limit`.
 * log_list(t, kind, after, out, n, e): the changes of a kind (NULL: of any) behind that number.
 * Both arrays are released by free().
 * log_walk_all(t, w, e): all logs, of a walk that has begun. */
enum status log_daemons(struct sql_txn *t, uint32_t *n, struct errinfo *e);
enum status log_page(struct sql_txn *t, const struct log_place *at, size_t limit,
                     struct log_entry **out, size_t *n, struct errinfo *e);
enum status log_list(struct sql_txn *t, const char *kind, uint64_t after,
                     struct log_entry **out, size_t *n, struct errinfo *e);
enum status log_walk_all(struct sql_txn *t, struct log_walk *w, struct errinfo *e);

#endif
