/* admin_copy.h -- the one way by which a store is copied: rows, and logs, under the keys of the
 * copy.  Restoring, a new key and archives are thin over it. */
#ifndef DB_ADMIN_COPY_H
#define DB_ADMIN_COPY_H
#include "admin_check.h"
#include "log_txn.h"
#include "newfile.h"
#include "rows_template.h"

/* admin_each(t, use, arg, e): every subject, in the order of creation, until use() fails.
 * admin_each_template(t, of, use, arg, e): the subject's, oldest first, with their faces.
 * Memory is that of a page of subjects and of one face. */
typedef enum status admin_use(void *arg, struct log_txn *t, const struct rows_subject *of,
                              struct errinfo *e);
typedef enum status admin_use_template(void *arg, struct rows_template *row,
                                       const void *face, size_t len, struct errinfo *e);
enum status admin_each(struct log_txn *t, admin_use *use, void *arg, struct errinfo *e);
enum status admin_each_template(struct log_txn *t, const struct rows_subject *of,
                                admin_use_template *use, void *arg, struct errinfo *e);

/* What a copy is made of, from one moment of a store. */
typedef enum status admin_fill(void *arg, struct log_txn *from, struct log_txn *to,
                               struct errinfo *e);

struct admin_copy {
    const struct crypt_root *root; /* of the copy, and what it opens; */
    const struct crypt *crypt;     /* both NULL: the store's own */
    const struct store_key *key;   /* by which the copy is opened, to be verified */
    admin_fill *fill;              /* admin_copy_all(), or more, or less */
    void *arg;                     /* of fill() */
    const struct log_act *by;
    const char *kind,
        *outcome;       /* of the copy's last change, which comes after fill(); or NULL */
    struct log_end end; /* set: of the copy's change log */
    struct admin_copied found; /* set: what is in the copy */
};

/* admin_copy(from, path, c, n, e): a copy as n->part, which has yet to get the name `path`: one file
 * without a WAL; or in the empty database of a server.  Verified whole.  O(bytes); one transaction.
 * ST_EEXISTS: that is not empty.
 * After it newfile_close(n) follows, also on failure.
 * admin_copy_all(arg, from, to, e): every subject, template, token, device, calibration, attempt and
 * nonce, and both logs.  Subjects have new keys in the copy.  The logs have the same hashes, so that
 * the copy goes on from where `from` ends.  ST_EREFUSED: the rows that were read are not those of
 * the last change of `from`; ST_ECORRUPT: an entry is not as it was written.
 * admin_copy_as_is(arg, from, to, e): the same rows with the same MACs, under the same keys, so that the
 * digest is the same, and the same logs.  Errors likewise.
 * admin_copy_subject(to, from, of, e): with its templates. */
enum status admin_copy(struct store *from, const char *path, struct admin_copy *c,
                       struct newfile *n, struct errinfo *e);
admin_fill admin_copy_all, admin_copy_as_is;
enum status admin_copy_subject(struct log_txn *to, struct log_txn *from,
                               const struct rows_subject *of, struct errinfo *e);

/* admin_in_file(path, instead, e): Returns ST_EINVAL if the database is on a server; the message says
 * what to do there instead. */
enum status admin_in_file(const char *path, const char *instead, struct errinfo *e);

/* admin_swap(path, held, n, aside, e): Gives the file n->part the name `path`.  If there is a database of
 * that name, held is it, open alone, and it is called `aside` from then on; held may be NULL.
 * Owner and group stay.
 * ST_EEXISTS: there is another file `aside`.  ST_EUNSYNCED: swapped, but perhaps not on the disk; both
 * databases are there, and the caller removes nothing.  Otherwise nothing was changed. */
enum status admin_swap(const char *path, struct store *held, struct newfile *n,
                       const char *aside, struct errinfo *e);

/* admin_discard(path, e): Overwrites a file that is not needed any more, and removes it.
 * ST_EUNSYNCED: removed, but perhaps not on the disk. */
enum status admin_discard(const char *path, struct errinfo *e);

#endif
