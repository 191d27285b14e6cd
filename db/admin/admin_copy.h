/* admin_copy.h -- the one way by which a store is copied: rows and logs, under the keys of the copy.  Restore,
 * rekey and archives use it. */
#ifndef DB_ADMIN_COPY_H
#define DB_ADMIN_COPY_H
#include "admin_check.h"
#include "log_txn.h"
#include "newfile.h"
#include "rows_template.h"

/* admin_each(t, use, arg, e): Calls use() for every subject, in the order of creation, until a call fails.  Memory:
 * one page of subjects. */
typedef enum status admin_use(void *arg, struct log_txn *t, const struct rows_subject *of,
                              struct errinfo *e);
enum status admin_each(struct log_txn *t, admin_use *use, void *arg, struct errinfo *e);

/* admin_each_template(t, of, use, arg, e): Calls use() for every template of the subject with its face, oldest
 * first, until a call fails.  Memory: one face. */
typedef enum status admin_use_template(void *arg, struct rows_template *row,
                                       const struct rows_face *face, struct errinfo *e);
enum status admin_each_template(struct log_txn *t, const struct rows_subject *of,
                                admin_use_template *use, void *arg, struct errinfo *e);

/* Fills a copy from one moment of a store. */
typedef enum status admin_fill(void *arg, struct log_txn *from, struct log_txn *to,
                               struct errinfo *e);

struct admin_copy {
    const struct crypt_root *root; /* key record of the copy; NULL: the store's */
    const struct crypt *crypt;     /* keys that root opens; NULL: the store's */
    const struct store_key *key;   /* key that opens the copy, to verify it */
    admin_fill *fill;              /* admin_copy_all(), or more, or less */
    void *arg;                     /* argument of fill() */
    const char *actor;          /* of the changes that are made in the copy; NULL: "" */
    const char *kind, *outcome; /* of the last one, after fill(); NULL: no such change */
    struct log_end end;         /* set: end of the copy's change log */
    struct admin_copied found;  /* set: counts of the copy */
};

/* admin_copy(from, path, c, n, e): Writes a copy in one transaction, and verifies it whole.  A file is one without
 * a WAL, called n->part: it has yet to get the name path.  On a server the database must be empty.
 *   n  to be released by newfile_close(), also after a failure
 * ST_EEXISTS: the database is not empty. */
enum status admin_copy(struct store *from, const char *path, struct admin_copy *c,
                       struct newfile *n, struct errinfo *e);

/* admin_copy_all(arg, from, to, e): Copies every subject, template, token, device, calibration, attempt and nonce,
 * and both logs.  Subjects have new keys in the copy.  The logs have the same hashes, so that the copy's
 * changes continue them.
 * ST_EREFUSED: the rows are not those of the last change of `from`; ST_ECORRUPT: an entry is not as it
 * was written. */
admin_fill admin_copy_all;

/* admin_copy_as_is(arg, from, to, e): Copies the rows with their MACs, under the same keys, so that the digest is
 * the same, and both logs.  Errors as admin_copy_all(). */
admin_fill admin_copy_as_is;

/* admin_copy_subject(to, from, of, e): Copies a subject with its templates. */
enum status admin_copy_subject(struct log_txn *to, struct log_txn *from,
                               const struct rows_subject *of, struct errinfo *e);

/* admin_in_file(path, instead, e): Returns ST_EINVAL if the database is on a server; the message says
 * what to do there instead. */
enum status admin_in_file(const char *path, const char *instead, struct errinfo *e);

/* admin_swap(path, held, n, aside, e): Gives the file n->part the name path.  Owner and group stay.
 *   held   the database of that name, open alone, which is called `aside` from then on; NULL: there is none
 * ST_EEXISTS: there is another file `aside`.  ST_EUNSYNCED: swapped, but perhaps not on the disk; both
 * databases are there, and the caller removes nothing.  Any other error: nothing was changed. */
enum status admin_swap(const char *path, struct store *held, struct newfile *n,
                       const char *aside, struct errinfo *e);

/* admin_unfinished(st, done, why, e): Returns st, the status of what follows the swap; if it is an error, fills *e with
 * what was done and the reason *why.
 *   done  "the database was restored" */
enum status admin_unfinished(enum status st, const char *done, const struct errinfo *why,
                             struct errinfo *e);

/* admin_discard(path, e): Overwrites a file that is not needed any more, and removes it.
 * ST_EUNSYNCED: removed, but perhaps not on the disk. */
enum status admin_discard(const char *path, struct errinfo *e);

#endif
