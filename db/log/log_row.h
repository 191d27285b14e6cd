/* log_row.h -- the entries of the logs as rows. */
#ifndef DB_LOG_ROW_H
#define DB_LOG_ROW_H
#include "log_walk.h"

struct sql_rows; /* sql.h */
struct sql_txn;

#define LOG_ROW_ACCESS "daemon, seq, at, kind, actor, uid, object, outcome, hash, mac"
#define LOG_ROW_CHANGE LOG_ROW_ACCESS ", digest, access_seq, access_hash, signature"

/* log_row_read(r, log, out): Reads the current row of these columns.  Returns false if it is damaged; out->seq is
 * then its number, or 0 if that is damaged too. */
bool log_row_read(const struct sql_rows *r, enum log_name log, struct log_entry *out);

/* log_row_add(t, entry, e): Inserts a row.  All members of *entry are set. */
enum status log_row_add(struct sql_txn *t, const struct log_entry *entry,
                        struct errinfo *e);

struct log_place { /* a position in a log */
    enum log_name log;
    uint32_t daemon; /* number of the daemon; changes: unused */
    bool newest;     /* direction: to earlier entries, the last first */
    uint64_t seq; /* number of the entry before; 0: the beginning, with newest the end */
};

/* log_daemons(t, n, e): Sets *n to the number of access logs: one more than the highest daemon with entries. */
enum status log_daemons(struct sql_txn *t, uint32_t *n, struct errinfo *e);

/* log_page(t, at, limit, out, n, e): Lists up to limit entries from a position on, without verifying them.
 *   out  a new array of *n elements, to be released by free()
 * ST_ECORRUPT: an entry cannot be read. */
enum status log_page(struct sql_txn *t, const struct log_place *at, size_t limit,
                     struct log_entry **out, size_t *n, struct errinfo *e);

/* log_list(t, kind, after, out, n, e): Lists the changes of a kind after number `after`, without verifying them.
 *   kind  NULL: all kinds
 *   out   as in log_page()
 * ST_ECORRUPT: an entry cannot be read. */
enum status log_list(struct sql_txn *t, const char *kind, uint64_t after,
                     struct log_entry **out, size_t *n, struct errinfo *e);

/* log_walk_all(t, w, e): Walks along all logs, after log_walk_begin(). */
enum status log_walk_all(struct sql_txn *t, struct log_walk *w, struct errinfo *e);

#endif
