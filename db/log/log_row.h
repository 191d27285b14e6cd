/* log_row.h -- the entries of the logs as rows. */
#ifndef DB_LOG_ROW_H
#define DB_LOG_ROW_H
#include "log_entry.h"

struct sql_rows; /* sql.h */
struct sql_txn;

#define LOG_ROW_ACCESS "seq, at, kind, actor, uid, object, outcome, hash, mac"
#define LOG_ROW_CHANGE LOG_ROW_ACCESS ", digest, access_seq, access_hash, signature"

/* log_row_read(r, log, out): the current row of these columns; false: damaged, and out->seq is
 * its number, 0 where that is damaged too. */
bool log_row_read(const struct sql_rows *r, enum log_name log, struct log_entry *out);

/* log_row_add(t, entry, e): a new row, complete. */
enum status log_row_add(struct sql_txn *t, const struct log_entry *entry,
                        struct errinfo *e);

#endif
