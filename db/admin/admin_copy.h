/* admin_copy.h -- the one way by which a store is copied as a whole: rows and logs under the keys
 * of the copy.  Restoring and a new key are thin over it. */
#ifndef DB_ADMIN_COPY_H
#define DB_ADMIN_COPY_H
#include "log_txn.h"
#include "store_open.h"

struct newfile; /* newfile.h */
struct sql;     /* sql.h */

struct admin_copy {
    const struct crypt_root *root; /* of the copy, and what it opens */
    const struct crypt *crypt;
    const struct log_act *by;
    const char *kind, *outcome; /* of the copy's last change */
    /* What the copy has not, or has besides, before that change; NULL: nothing. */
    enum status (*amend)(void *arg, struct log_txn *to, struct errinfo *e);
    void *arg;
};

/* admin_copy(from, path, what, end, e): every subject, template, token, device, calibration,
 * attempt and nonce, and both logs, of one moment, into an empty file: one file without a WAL, not
 * yet on the disk.  Subjects have new keys in it.  The logs have the same hashes, so that the copy
 * goes on from where `from` ends.  *end: of its change log.  `from` was verified by the caller.
 * O(bytes); one transaction, so that it takes twice the room for the time. */
enum status admin_copy(struct store *from, const char *path,
                       const struct admin_copy *what, struct log_end *end,
                       struct errinfo *e);

/* admin_swap(path, held, n, aside, e): the file n->part gets the name `path`, in the place of the
 * database that is open alone there, which is closed then; NULL: there is none.  What was there is
 * called `aside` from then on.  ST_EEXISTS: there is another file of that name.
 * admin_discard(path, e): the bytes of a database that is not needed any more are overwritten, and
 * the file removed.
 * admin_name(path, suffix): a new text, released by free(); NULL: no memory. */
enum status admin_swap(const char *path, struct store *held, struct newfile *n,
                       const char *aside, struct errinfo *e);
enum status admin_discard(const char *path, struct errinfo *e);
char *admin_name(const char *path, const char *suffix);

#endif
