/* log_anchor.h -- a file outside the database, best on another disk or host, which records how far the
 * change log has come: an attacker who has only the database cannot put all of it back to an older
 * state.
 *
 * The file has two places of one line each, written in turn, so that a torn write leaves the line
 * before it.  Each line has a MAC by the database's key.  A new anchor is written whole as PATH.part
 * before the change that it names is committed, and renamed after that.  If the command is killed
 * between the two, PATH.part is the database's anchor: it names a change that the database has.  A
 * symbolic link at PATH is followed and kept. */
#ifndef DB_LOG_ANCHOR_H
#define DB_LOG_ANCHOR_H
#include "log_entry.h"

struct newfile; /* newfile.h */

struct log_anchor {
    uint32_t daemon;    /* number of the daemon whose anchor it is */
    struct log_end end; /* the newest change */
};

/* log_anchor_read(path, c, out, e): Reads the later of the two lines.  ST_ENOTFOUND: there is no file.
 * ST_EREFUSED: neither line is authentic.  ST_EIO. */
enum status log_anchor_read(const char *path, const struct crypt *c,
                            struct log_anchor *out, struct errinfo *e);

/* log_anchor_left(path, c, out, e): Like log_anchor_read(), but reads PATH.part. */
enum status log_anchor_left(const char *path, const struct crypt *c,
                            struct log_anchor *out, struct errinfo *e);

/* log_anchor_unknown(read): Returns true if this status of log_anchor_read() or log_anchor_left() leaves
 * open what the file says: neither was it read, nor is it missing, damaged or another database's. */
bool log_anchor_unknown(enum status read);

/* log_anchor_adopt(path, e): Renames PATH.part to PATH, if there is a part.  ST_EIO: that failed, or a
 * command is writing the part; it is found again.  ST_ENOMEM. */
enum status log_anchor_adopt(const char *path, struct errinfo *e);

/* log_anchor_prepare(path, c, at, n, e): Writes a new anchor as PATH.part and flushes it to the disk.
 * After the commit the caller gives it its name by newfile_commit(n).  Errors as newfile_open() and
 * newfile_sync(); newfile_close(n) or newfile_leave(n) follows in any case. */
enum status log_anchor_prepare(const char *path, const struct crypt *c,
                               const struct log_anchor *at, struct newfile *n,
                               struct errinfo *e);

/* log_anchor_advance(path, c, at, e): Writes *at unless the anchor has a later change.  Makes the anchor
 * anew if it is missing or damaged.  Does not flush an existing anchor: after a loss of power it may be
 * older than the database, which is accepted.  ST_EIO, ST_EDENIED, ST_EBUSY, ST_EUNSYNCED, ST_ENOMEM. */
enum status log_anchor_advance(const char *path, const struct crypt *c,
                               const struct log_anchor *at, struct errinfo *e);

#endif
