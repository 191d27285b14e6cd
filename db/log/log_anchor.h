/* log_anchor.h -- a file outside of the database, best on another disk or host, which says how far
 * the change log has come: who has only the database cannot put all of it back to an older state.
 * One line in each of two places, written in turn, so that a torn write leaves the one before;
 * each with a MAC of the database's key. */
#ifndef DB_LOG_ANCHOR_H
#define DB_LOG_ANCHOR_H
#include "log_entry.h"

struct log_anchor {
    uint32_t daemon; /* whose it is */
    struct log_end end;
};

/* log_anchor_read(path, c, out, e): the later of the two.  ST_ENOTFOUND: there is no file;
 * ST_EREFUSED: no place is authentic; ST_EIO.
 * log_anchor_write(path, c, at, force, e): it never goes back, unless `force`.  Not synced: after a loss
 * of power it may lag, which refuses nothing.  ST_EIO. */
enum status log_anchor_read(const char *path, const struct crypt *c,
                            struct log_anchor *out, struct errinfo *e);
enum status log_anchor_write(const char *path, const struct crypt *c,
                             const struct log_anchor *at, bool force, struct errinfo *e);

#endif
