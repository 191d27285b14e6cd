#include "admin_rekey.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "admin_copy.h"
#include "crypt_file.h"
#include "log_anchor.h"
#include "log_row.h"
#include "sql_file.h"
#include "store_txn.h"

#define STICKY 01000 /* S_ISVTX, which POSIX leaves to XSI */

struct rekeying {
    char *path;                   /* the database's file, behind all links */
    const struct store_key *key;  /* how the database is opened before */
    const struct admin_rekey *to; /* the new key */
    char *key_path;               /* the key's file, behind all links */
    char *key_new, *key_old;      /* files beside it */
    char *discard, *kept;         /* names of the old database: to be removed, or kept */
    struct crypt_root root;       /* of the copy, */
    struct crypt *crypt;          /* and its keys */
    bool made;                    /* key_new was made by this call */
    bool swapped;                 /* the copy may have the database's name */
};

static enum status name_files(struct rekeying *x, const char *path, struct errinfo *e)
{
    const struct {
        const char *path, *suffix;
        char **out;
    } name[] = {
        {path, "", &x->path},
        {path, ".discard", &x->discard},
        {path, ".before-rekey", &x->kept},
        {x->key->path, "", &x->key_path},
        {x->key->path, STORE_KEY_NEW, &x->key_new},
        {x->key->path, ".old", &x->key_old},
    };
    enum status st = ST_OK;

    for (size_t i = 0; i < sizeof name / sizeof *name && st == ST_OK; i++)
        st = newfile_beside(name[i].path, name[i].suffix, name[i].out, e);
    return st;
}

static void free_files(struct rekeying *x)
{
    crypt_free(x->crypt);
    free(x->path);
    free(x->key_path);
    free(x->key_new);
    free(x->key_old);
    free(x->discard);
    free(x->kept);
}

/* Is the new secret in the key's file? */
static bool in_file(const struct admin_rekey *to)
{
    return to->kind != CRYPT_PLAINTEXT && (to->given == NULL || to->in_file);
}

/* ---- whose key is it? */

/* Is there a key file, and does it open the database at path? */
static enum status fits(const char *key, const char *path, bool *out, struct errinfo *e)
{
    struct crypt_root root;
    enum status st;

    *out = false;
    if (newfile_missing(key))
        return ST_OK;
    if ((st = store_root(path, &root, e)) != ST_OK)
        return st;
    return crypt_file_fits(key, &root, out, e);
}

/* Is the database opened as the caller says? */
static enum status opens(const struct store_key *key, const char *path, bool *out,
                         struct errinfo *e)
{
    struct crypt_root root;
    struct crypt *c = NULL;
    enum status st;

    if (key->given == NULL && !key->plaintext)
        return fits(key->path, path, out, e);
    if ((st = store_root(path, &root, e)) != ST_OK)
        return st;
    *out = root.kind == CRYPT_PLAINTEXT
               ? key->plaintext
               : key->given != NULL &&
                     crypt_file_open(key->given, "the key", &root, &c, NULL) == ST_OK;
    crypt_free(c);
    return ST_OK;
}

/* No database beside path, and not that itself, is opened by the key. */
static enum status fits_none(const char *key, const char *path, bool *none,
                             struct errinfo *e)
{
    static const char *const beside[] = {"", ".discard", ".before-rekey",
                                         ".before-restore"};
    enum status st = ST_OK;

    *none = true;
    for (size_t i = 0; i < sizeof beside / sizeof *beside && st == ST_OK && *none; i++) {
        bool it = false;
        char *name;

        if ((st = newfile_beside(path, beside[i], &name, e)) == ST_OK &&
            !newfile_missing(name) && (st = fits(key, name, &it, e)) == ST_OK)
            *none = !it;
        free(name);
    }
    return st;
}

enum status admin_rekey_left(const char *path, const struct store_key *key,
                             enum admin_left *out, struct errinfo *e)
{
    bool is_key = false, other_is = false, none = false;
    char *key_new;
    enum status st = newfile_beside(key->path, STORE_KEY_NEW, &key_new, e);

    *out = ADMIN_LEFT_NOTHING;
    if (st != ST_OK)
        return st;
    if (sodium_init() < 0)
        st = errinfo_set(e, ST_EINTERNAL, "the cryptographic library does not start");
    else if (crypt_file_wiped(key_new))
        none = true;
    else if (!newfile_missing(key_new) &&
             (st = fits(key_new, path, &is_key, e)) == ST_OK && !is_key &&
             (st = opens(key, path, &other_is, e)) == ST_OK && other_is)
        st = fits_none(key_new, path, &none, e);
    if (st == ST_OK && !newfile_missing(key_new))
        *out = is_key ? ADMIN_LEFT_KEY : none ? ADMIN_LEFT_USELESS : ADMIN_LEFT_UNKNOWN;
    free(key_new);
    return st;
}

/* ---- the end of a rekey, which is also that of one that was interrupted */

/* The new key is for the users that the old one is for. */
static void own_as(const char *path, const char *like)
{
    const int fd = open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);

    if (fd >= 0) {
        newfile_like(fd, like);
        (void)close(fd);
    }
}

/* The new key into its place.  An old one in that place becomes KEY.old, also if no other comes, but
 * only if that was asked for: an attacker who can write the folder can make it look so. */
static enum status place_key(const struct rekeying *x, const char *aside,
                             struct errinfo *e)
{
    const bool comes = !newfile_missing(x->key_new);
    bool is_new = false, is_old = false;
    enum status st = ST_OK;

    if (comes && !newfile_missing(x->key_path))
        is_old = true;
    else if (!comes && !in_file(x->to) &&
             (st = fits(x->key_path, x->path, &is_new, e)) == ST_OK && !is_new)
        st = fits(x->key_path, aside, &is_old, e);
    if (comes && is_old)
        own_as(x->key_new, x->key_path);
    if (st == ST_OK && is_old)
        st = newfile_rename(x->key_path, x->key_old, e);
    return st == ST_OK && comes ? newfile_rename(x->key_new, x->key_path, e) : st;
}

/* How the database is opened under its new key: by the key's file, or as it was given.  Plaintext only
 * if that was asked for. */
static enum status opening(const struct rekeying *x, struct store_key *out,
                           struct errinfo *e)
{
    bool by_file = false;
    enum crypt_kind kind;
    enum status st;

    if ((st = store_kind(x->path, &kind, e)) != ST_OK ||
        (st = fits(x->key_path, x->path, &by_file, e)) != ST_OK)
        return st;
    *out = (struct store_key){.path = x->key_path,
                              .anchor = x->key->anchor,
                              .plaintext =
                                  kind == CRYPT_PLAINTEXT &&
                                  (x->key->plaintext || x->to->kind == CRYPT_PLAINTEXT),
                              .given = by_file || kind == CRYPT_PLAINTEXT ? NULL
                                       : x->to->given != NULL             ? x->to->given
                                                              : x->key->given};
    return ST_OK;
}

/* *last: the rekey is the newest change. */
static enum status open_and_read(const struct rekeying *x, bool *last, struct errinfo *e)
{
    struct log_entry *list = NULL;
    struct store_key key;
    struct store *s = NULL;
    struct log_txn t;
    size_t n = 0;
    enum status st;

    if ((st = opening(x, &key, e)) == ST_OK &&
        (st = store_open(x->path, STORE_WRITE, &key, &s, e)) == ST_OK &&
        (st = store_begin(s, SQL_READ, &t, e)) == ST_OK) {
        st = log_list(t.sql, "rekey", t.changes.seq - 1, &list, &n, e);
        st = store_end(s, &t, st, e);
    }
    *last = n > 0;
    free(list);
    store_close(s);
    return st;
}

static enum status flush_names(const char *path, struct errinfo *e)
{
    const int folder = newfile_open_directory(path);
    const bool done = folder >= 0 && newfile_sync_directory(folder);

    if (!done)
        (void)errinfo_set(e, ST_EUNSYNCED, "the folder of %.160s cannot be flushed: %s",
                          path, strerror(errno));
    if (folder >= 0)
        (void)close(folder);
    return done ? ST_OK : ST_EUNSYNCED;
}

/* Is KEY.old that of the old database, and of none that is kept?  Or was it overwritten by a call that
 * could not remove it then? */
static enum status is_old_key(const struct rekeying *x, bool *out, struct errinfo *e)
{
    bool kept = false;
    enum status st = ST_OK;

    if (!(*out = crypt_file_wiped(x->key_old)) &&
        (st = fits(x->key_old, x->discard, out, e)) == ST_OK && *out &&
        !newfile_missing(x->kept))
        st = fits(x->key_old, x->kept, &kept, e);
    *out = *out && !kept;
    return st;
}

/* Keys are placed, the database is opened by them and read, and only then the old ones go. */
static enum status admin_rekey_finish(const struct rekeying *x, bool *last,
                                      struct errinfo *e)
{
    const bool discard = !newfile_missing(x->discard);
    const char *aside = discard ? x->discard : x->kept;
    bool old = false;
    struct errinfo why;
    enum status st;

    if ((st = flush_names(x->path, &why)) == ST_OK &&
        (st = place_key(x, aside, &why)) == ST_OK &&
        (st = open_and_read(x, last, &why)) == ST_OK && discard &&
        (st = is_old_key(x, &old, &why)) == ST_OK) {
        if (old)
            st = admin_discard(x->key_old, &why);
        if (st == ST_OK)
            st = admin_discard(x->discard, &why);
    }
    return admin_unfinished(st, "the key was changed", &why, e);
}

/* ---- what one that was interrupted has left */

static enum status drop_second_name(const char *path, const char *second,
                                    struct errinfo *e)
{
    return !sql_file_same(path, second) || unlink(second) == 0
               ? ST_OK
               : errinfo_set(e, ST_EIO, "cannot remove %.160s: %s", second,
                             strerror(errno));
}

/* Is the database under the key that is asked for? */
static enum status is_asked(const struct rekeying *x, bool *out, struct errinfo *e)
{
    struct crypt_root root;
    struct crypt *c = NULL;
    enum status st = store_root(x->path, &root, e);

    *out = st == ST_OK && root.kind == x->to->kind &&
           (x->to->given == NULL ||
            crypt_file_open(x->to->given, "the new key", &root, &c, NULL) == ST_OK);
    crypt_free(c);
    return st;
}

/* The old database and its key, as an earlier call was to keep them. */
static enum status is_kept(const struct rekeying *x, bool *out, struct errinfo *e)
{
    *out = false;
    return x->to->keep && !newfile_missing(x->kept) ? fits(x->key_old, x->kept, out, e)
                                                    : ST_OK;
}

/* *done: it was this very rekey, and nothing has changed since. */
static enum status admin_rekey_settle(struct rekeying *x, bool *done, struct errinfo *e)
{
    enum admin_left left;
    bool kept = false, last = false;
    enum status st;

    *done = false;
    if ((st = drop_second_name(x->path, x->discard, e)) != ST_OK ||
        (st = drop_second_name(x->path, x->kept, e)) != ST_OK ||
        (st = admin_rekey_left(x->path, x->key, &left, e)) != ST_OK ||
        (st = is_kept(x, &kept, e)) != ST_OK)
        return st;
    if (left == ADMIN_LEFT_UNKNOWN)
        return errinfo_set(
            e, ST_EEXISTS,
            "there is a key %.160s that does not open this database, and may "
            "be another's: move it away first",
            x->key_new);
    if (left == ADMIN_LEFT_USELESS && (st = admin_discard(x->key_new, e)) != ST_OK)
        return st;
    if (left != ADMIN_LEFT_KEY && newfile_missing(x->discard) && !kept)
        return ST_OK;
    if ((st = admin_rekey_finish(x, &last, e)) != ST_OK || !last)
        return st;
    return is_asked(x, done, e);
}

/* ---- what is found before anything is changed */

/* In a sticky folder only their owner renames files. */
static bool may_rename(const char *path)
{
    const int fd = newfile_open_directory(path);
    struct stat folder, file;
    const bool may = fd >= 0 && fstat(fd, &folder) == 0 && lstat(path, &file) == 0 &&
                     faccessat(fd, ".", W_OK | X_OK, AT_EACCESS) == 0 &&
                     ((folder.st_mode & STICKY) == 0 || geteuid() == 0 ||
                      geteuid() == folder.st_uid || geteuid() == file.st_uid);

    if (fd >= 0)
        (void)close(fd);
    return may;
}

/* Will the old key's file be renamed, and then overwritten, when the time comes? */
static enum status check_old_key(const struct rekeying *x, struct errinfo *e)
{
    struct stat sb;

    if (stat(x->key_path, &sb) != 0)
        return ST_OK; /* to open the database says why not */
    if (!S_ISREG(sb.st_mode))
        return errinfo_set(e, ST_EINVAL,
                           "the key %.160s is not a file, so another cannot be put in "
                           "its place: name a file with --key",
                           x->key_path);
    if (!newfile_missing(x->key_old))
        return errinfo_set(e, ST_EEXISTS,
                           "there is a key %.200s already: move it away first",
                           x->key_old);
    if (faccessat(AT_FDCWD, x->key_path, W_OK, AT_EACCESS) != 0 && errno == EROFS)
        return errinfo_set(e, ST_EDENIED,
                           "the key %.160s is on a read-only file system, as a systemd "
                           "credential is: name the file that it comes from with --key",
                           x->key_path);
    if (!may_rename(x->key_path) ||
        (!x->to->keep && faccessat(AT_FDCWD, x->key_path, W_OK, AT_EACCESS) != 0))
        return errinfo_set(e, ST_EDENIED,
                           "the key %.160s belongs to user %u, and this user may not %s "
                           "it: run this as its owner%s",
                           x->key_path, (unsigned)sb.st_uid,
                           x->to->keep ? "rename" : "replace and overwrite",
                           x->to->keep ? "" : ", or with --keep-old");
    return ST_OK;
}

static enum status check_files(const struct rekeying *x, struct errinfo *e)
{
    const char *aside = x->to->keep ? x->kept : x->discard;

    if (!newfile_missing(aside))
        return errinfo_set(e, ST_EEXISTS,
                           "there is a database %.200s already: move it away first, or "
                           "overwrite and remove it (shred -u)",
                           aside);
    if (x->key->given == NULL && !x->key->plaintext)
        return check_old_key(x, e);
    if (in_file(x->to) && !newfile_missing(x->key_path))
        return errinfo_set(e, ST_EEXISTS,
                           "there is a file %.160s, where the new key would be: move it "
                           "away first",
                           x->key_path);
    return ST_OK;
}

/* ---- a rekey */

static enum status make_keys(struct rekeying *x, struct errinfo *e)
{
    const struct crypt_file *k = x->to->given;
    struct crypt_file *read = NULL;
    enum status st = ST_OK;

    if (in_file(x->to)) {
        st = k != NULL ? crypt_file_copy(k, x->key_new, e)
                       : crypt_file_make(x->key_new, e);
        x->made = st == ST_OK || st == ST_EUNSYNCED;
        if (st == ST_OK && (st = crypt_file_read(x->key_new, &read, e)) == ST_OK)
            k = read; /* as it will be read */
    }
    if (st == ST_OK && x->to->kind == CRYPT_PLAINTEXT)
        st = crypt_make(CRYPT_PLAINTEXT, NULL, 0, &x->root, &x->crypt, e);
    else if (st == ST_OK)
        st = crypt_file_root(k, x->key_new, x->to->kind, &x->root, &x->crypt, e);
    crypt_file_free(read);
    return st;
}

/* Whether it was or not, the anchor's part is that of the database that is there. */
static enum status swap(struct rekeying *x, struct store *s, struct newfile *n,
                        struct newfile *anchor, struct errinfo *e)
{
    struct errinfo why;
    enum status st = admin_swap(x->path, s, n, x->to->keep ? x->kept : x->discard, &why);

    x->swapped = st == ST_OK || st == ST_EUNSYNCED;
    if (!x->swapped)
        return errinfo_set(e, st, "%s", why.msg);
    if (st == ST_OK && x->key->anchor != NULL)
        st = newfile_commit(anchor, &why);
    newfile_leave(anchor);
    return admin_unfinished(st, "the key was changed", &why, e);
}

static enum status copy_and_swap(struct rekeying *x, struct store *s, const char *actor,
                                 struct errinfo *e)
{
    static const char *const word[] = {"plaintext", "file", "passphrase"};
    /* How the copy is opened, before the keys are in their places. */
    const struct store_key opens = {.path = x->key_new,
                                    .given = in_file(x->to) ? NULL : x->to->given,
                                    .plaintext = x->to->kind == CRYPT_PLAINTEXT};
    struct admin_copy c = {.root = &x->root,
                           .crypt = x->crypt,
                           .key = &opens,
                           .fill = admin_copy_all,
                           .actor = actor,
                           .kind = "rekey",
                           .outcome = word[x->to->kind]};
    struct newfile n = NEWFILE_NONE, anchor = NEWFILE_NONE;
    enum status st;

    if ((st = admin_copy(s, x->path, &c, &n, e)) == ST_OK && x->key->anchor != NULL)
        st = log_anchor_prepare(x->key->anchor, x->crypt,
                                &(struct log_anchor){.end = c.end}, &anchor, e);
    if (st == ST_OK)
        st = swap(x, s, &n, &anchor, e);
    newfile_close(&anchor);
    newfile_close(&n);
    return st;
}

/* Nothing was swapped: the new key goes, but only if the database does not open by it. */
static void drop_new_key(const struct rekeying *x)
{
    bool it = true;

    if (fits(x->key_new, x->path, &it, NULL) == ST_OK && !it)
        (void)unlink(x->key_new);
}

static enum status rekey(struct rekeying *x, const char *actor, bool *completed,
                         struct errinfo *e)
{
    struct store *s;
    bool last;
    enum status st;

    if ((st = admin_rekey_settle(x, completed, e)) != ST_OK || *completed ||
        (st = check_files(x, e)) != ST_OK ||
        (st = store_open(x->path, STORE_ALONE, x->key, &s, e)) != ST_OK)
        return st;
    if ((st = store_verify(s, NULL, NULL, e)) == ST_OK && (st = make_keys(x, e)) == ST_OK)
        st = copy_and_swap(x, s, actor, e);
    store_close(s);
    if (st == ST_OK)
        return admin_rekey_finish(x, &last, e);
    if (x->made && !x->swapped)
        drop_new_key(x);
    return st;
}

enum status admin_rekey(const char *path, const struct store_key *key,
                        const struct admin_rekey *to, const char *actor, bool *completed,
                        struct errinfo *e)
{
    struct rekeying x = {.key = key, .to = to};
    int lock = -1;
    enum status st = ST_OK;

    *completed = false;
    if ((to->kind == CRYPT_PASSPHRASE && to->given == NULL) ||
        (to->kind == CRYPT_PLAINTEXT && to->given != NULL))
        return errinfo_set(e, ST_EINVAL, "a key of another kind");
    if (to->kind == CRYPT_PASSPHRASE && !to->weak &&
        (st = crypt_file_strong(to->given, e)) != ST_OK)
        return st;
    if ((st = admin_in_file(path,
                            "copy it into a file (surfacectl copy), rekey that, and copy "
                            "it into an empty database",
                            e)) != ST_OK)
        return st;
    if ((st = name_files(&x, path, e)) == ST_OK &&
        (st = crypt_file_lock(x.key_path, &lock, e)) == ST_OK)
        st = rekey(&x, actor, completed, e);
    if (lock >= 0)
        (void)close(lock);
    free_files(&x);
    return st;
}
