#include "admin_rekey.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#include "admin_copy.h"
#include "crypt_file.h"
#include "log_anchor.h"
#include "sql_file.h"
#include "store_txn.h"

#define ASIDE ".before-rekey"

struct rekeying {
    const char *path;
    const struct store_key *key;
    const struct admin_rekey *to;
    char *key_new, *key_old, *aside;
    struct crypt_root root;
    struct crypt *crypt;
    bool made; /* key_new, by this call */
};

static bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

static bool name_files(struct rekeying *x)
{
    x->key_new = admin_name(x->key->path, ".new");
    x->key_old = admin_name(x->key->path, ".old");
    x->aside = admin_name(x->path, ASIDE);
    return x->key_new != NULL && x->key_old != NULL && x->aside != NULL;
}

/* Is the new secret in the key's file? */
static bool in_file(const struct admin_rekey *to)
{
    return to->kind != CRYPT_PLAINTEXT && (to->given == NULL || to->in_file);
}

/* A rekey that was killed has left KEY.new: the database's key, or one that nothing needs. */
static enum status settle_key(struct rekeying *x, struct errinfo *e)
{
    struct store_key by = *x->key;
    struct store *s;

    if (!is_there(x->key_new))
        return ST_OK;
    by.path = x->key_new;
    by.given = NULL;
    if (store_open(x->path, STORE_READ, &by, &s, NULL) != ST_OK)
        return unlink(x->key_new) == 0
                   ? ST_OK
                   : errinfo_set(e, ST_EIO, "cannot remove %.160s: %s", x->key_new,
                                 strerror(errno));
    store_close(s);
    return crypt_file_move(x->key_new, x->key->path, e);
}

static enum status need_room(const struct rekeying *x, struct errinfo *e)
{
    /* One that was killed may have left a second name of the database. */
    if (is_there(x->aside) && !sql_file_same(x->path, x->aside))
        return errinfo_set(e, ST_EEXISTS,
                           "there is a database %.200s already: move it away first, or "
                           "overwrite and remove it (shred -u)",
                           x->aside);
    if (x->to->keep && is_there(x->key_old))
        return errinfo_set(e, ST_EEXISTS,
                           "there is a key %.200s already: move it away first",
                           x->key_old);
    return ST_OK;
}

static enum status make_keys(struct rekeying *x, struct errinfo *e)
{
    const struct crypt_file *k = x->to->given;
    struct crypt_file *read = NULL;
    enum status st = ST_OK;

    if (in_file(x->to)) {
        st = k != NULL ? crypt_file_copy(k, x->key_new, e)
                       : crypt_file_make(x->key_new, e);
        x->made = st == ST_OK;
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

static enum status copy_and_swap(struct rekeying *x, struct store *s,
                                 const struct log_act *by, struct log_end *end,
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
                           .by = by,
                           .kind = "rekey",
                           .outcome = word[x->to->kind]};
    struct newfile n = NEWFILE_NONE;
    enum status st;

    if ((st = admin_copy(s, x->path, &c, &n, e)) == ST_OK)
        st = admin_swap(x->path, s, &n, ASIDE, e);
    newfile_close(&n);
    *end = c.end;
    return st;
}

/* The old key out of its place, the new one into it. */
static enum status place_key(const struct rekeying *x, bool fits, struct errinfo *e)
{
    enum status st = ST_OK;

    if (fits && x->to->keep)
        st = crypt_file_move(x->key->path, x->key_old, e);
    else if (fits)
        st = admin_discard(x->key->path, e);
    return st == ST_OK && x->made ? crypt_file_move(x->key_new, x->key->path, e) : st;
}

static enum status finish(struct rekeying *x, bool fits, const struct log_end *end,
                          struct errinfo *e)
{
    struct errinfo why;
    enum status st = place_key(x, fits, &why);

    if (st == ST_OK && x->key->anchor != NULL)
        st = log_anchor_write(x->key->anchor, x->crypt, &(struct log_anchor){.end = *end},
                              true, &why);
    if (st == ST_OK && !x->to->keep)
        st = admin_discard(x->aside, &why);
    return st == ST_OK ? st
                       : errinfo_set(e, st, "the key was changed, but %.400s", why.msg);
}

static enum status rekey(struct rekeying *x, const char *actor, struct errinfo *e)
{
    struct log_end end;
    struct log_act by;
    struct store *s;
    bool fits;
    enum status st;

    if ((st = log_act(&by, actor, e)) != ST_OK || (st = settle_key(x, e)) != ST_OK ||
        (st = need_room(x, e)) != ST_OK ||
        (st = store_open(x->path, STORE_ALONE, x->key, &s, e)) != ST_OK)
        return st;
    fits = x->key->given == NULL && !x->key->plaintext;
    if ((st = store_verify(s, NULL, NULL, e)) == ST_OK && (st = make_keys(x, e)) == ST_OK)
        st = copy_and_swap(x, s, &by, &end, e);
    store_close(s);
    if (st == ST_OK)
        return finish(x, fits, &end, e);
    if (x->made)
        (void)unlink(x->key_new);
    return st;
}

enum status admin_rekey(const char *path, const struct store_key *key,
                        const struct admin_rekey *to, const char *actor,
                        struct errinfo *e)
{
    struct rekeying x = {.path = path, .key = key, .to = to};
    int lock = -1;
    enum status st = ST_OK;

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
    if (!name_files(&x))
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
    if (st == ST_OK && (st = crypt_file_lock(key->path, &lock, e)) == ST_OK)
        st = rekey(&x, actor, e);
    if (lock >= 0)
        (void)close(lock);
    crypt_free(x.crypt);
    free(x.key_new);
    free(x.key_old);
    free(x.aside);
    return st;
}
