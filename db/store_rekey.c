/* Two things change, the database and the key's file, and either may be the last that did: so
 * the new key is on the disk, beside the old one, from before the database's commit until it is
 * in its place (store_vault.c looks in both). */
#include "store_rekey.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "errinfo.h"
#include "keyfile.h"
#include "anchor.h"
#include "row_event.h"
#include "sql_file.h"
#include "store_column.h"
#include "store_anchor.h"
#include "store_renew.h"
#include "store_rules.h"
#include "row_crypt.h"
#include "store_txn.h"

struct files {
    const char *key;
    char *next, *old; /* KEY.new, KEY.old */
    bool fits;        /* KEY is the database's key */
    bool wanted;      /* the new key goes into KEY */
    bool made;        /* KEY.new is the new key, by this change */
    bool aside;       /* KEY.new is the old key, which nothing replaces */
};

static enum status name_files(struct store_vaults *v, const struct store_rekey *to,
                              struct files *f, struct errinfo *e)
{
    const size_t n = strlen(v->path) + sizeof ".new";

    *f = (struct files){.key = v->path, .next = malloc(n), .old = malloc(n)};
    f->wanted = to->kind == VAULT_FILE || to->in_file;
    if (f->next == NULL || f->old == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(f->next, n, "%s.new", v->path);
    (void)snprintf(f->old, n, "%s.old", v->path);
    return ST_OK;
}

static bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

/* What an earlier change has left, and whether anything is in the way of this one. */
static enum status settle(struct files *f, const struct vault_root *root,
                          const struct store_rekey *to, struct errinfo *e)
{
    enum status st;

    if (is_there(f->next)) {
        if (!store_vault_fits(f->next, root))
            return errinfo_set(
                e, ST_EEXISTS,
                "there is %.140s, of a change that was not made: remove it", f->next);
        if ((st = keyfile_move(f->next, f->key, e)) != ST_OK)
            return st;
    }
    f->fits = store_vault_fits(f->key, root);
    if ((f->wanted || to->kind == VAULT_PLAINTEXT) && !f->fits && is_there(f->key))
        return errinfo_set(e, ST_EEXISTS,
                           "there is %.140s already, which is not this database's key",
                           f->key);
    if (to->keep && is_there(f->old))
        return errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", f->old);
    return ST_OK;
}

/* The same before anything is written. */
static enum status settle_now(struct store *s, struct files *f,
                              const struct store_rekey *to, struct errinfo *e)
{
    struct vault_root root;
    struct store_txn t;
    enum status st = store_txn_begin(s, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    if ((st = store_vault_read(t.sql, &root, e)) == ST_OK)
        st = settle(f, &root, to, e);
    return store_txn_end(&t, st, e);
}

/* The new key's file, and the root and vault under that key. */
static enum status make_vault(struct store_txn *t, const struct store_rekey *to,
                              const struct vault_root *from, struct files *f,
                              struct vault_root *root, struct vault **out,
                              struct errinfo *e)
{
    enum status (*const make)(const struct vault *, const struct vault_root *,
                              enum vault_kind, const void *, size_t, struct vault_root *,
                              struct vault **, struct errinfo *) =
        to->compromised ? vault_renew : vault_change;
    unsigned char key[VAULT_KEY];
    const struct keyfile *k = to->given;
    struct keyfile *read = NULL;
    enum status st = ST_OK;

    if (f->wanted) {
        st = k != NULL ? keyfile_copy(k, f->next, e) : keyfile_make(f->next, e);
        f->made = st == ST_OK;
        if (st == ST_OK && (st = keyfile_read(f->next, &read, e)) == ST_OK)
            k = read; /* as it will be read */
    }
    if (st == ST_OK && to->kind == VAULT_FILE) {
        if ((st = keyfile_key(k, f->next, key, e)) == ST_OK)
            st = make(t->vault, from, to->kind, key, sizeof key, root, out, e);
    } else if (st == ST_OK) {
        st = make(t->vault, from, to->kind, k != NULL ? k->text : NULL,
                  k != NULL ? k->len : 0, root, out, e);
    }
    sodium_memzero(key, sizeof key);
    keyfile_free(read);
    return st;
}

static enum status wrap(struct store_txn *t, const struct vault *next,
                        const struct sql_rows *row, struct errinfo *e)
{
    unsigned char uid[ROW_CRYPT_UID], wrapped[VAULT_WRAPPED];
    const int64_t number = sql_column(row, 0).i;
    struct row_crypt_key k;

    if (!store_column_bytes(row, 1, uid, sizeof uid) ||
        !store_column_bytes(row, 2, wrapped, sizeof wrapped) ||
        !row_crypt_key(t->vault, uid, wrapped, &k))
        return errinfo_set(e, ST_ECORRUPT, "a subject's key is damaged (row %lld)",
                           (long long)number);
    vault_wrap(next, uid, k.key, wrapped);
    sodium_memzero(&k, sizeof k);
    return SQL_RUN(t->sql, e, "UPDATE subjects SET key = $2 WHERE subject_key = $1",
                   sql_int(number), sql_blob(wrapped, sizeof wrapped));
}

static enum status wrap_all(struct store_txn *t, const struct vault *next,
                            struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = sql_query(
        t->sql, "SELECT subject_key, uid, key FROM subjects ORDER BY subject_key", NULL,
        0, &r, e);

    while (st == ST_OK && sql_next(r))
        st = wrap(t, next, r, e);
    return sql_done(r, st, e);
}

/* A plaintext database is refused beside KEY, which must therefore be gone when the database
 * is plaintext; as KEY.new it still opens what is not changed yet. */
static enum status set_aside(struct files *f, struct errinfo *e)
{
    enum status st = ST_OK;

    if (f->fits && !f->wanted) {
        st = keyfile_move(f->key, f->next, e);
        f->aside = st == ST_OK;
    }
    return st;
}

/* Nothing was changed: KEY.new goes, or goes back.  Where that fails it is found there. */
static void take_back(const struct files *f)
{
    if (f->aside)
        (void)keyfile_move(f->next, f->key, NULL);
    else if (f->made)
        (void)unlink(f->next);
}

/* What the anchor says has a MAC of the database's key, which is another one from the commit on:
 * whichever is in force then finds its own. */
static enum status announce(struct store_txn *t, const struct vault *before,
                            struct anchor_end *end, bool *served, struct errinfo *e)
{
    const char *path = t->store->anchor.path;
    struct anchor a;
    enum status st = store_anchor_end(t->sql, t->vault, end, e);

    if (st != ST_OK || path == NULL)
        return st;
    if ((st = anchor_read(path, before, &a, e)) != ST_OK ||
        (st = anchor_set(path, before, a.said ? &a.last : &a.next, a.served, e)) != ST_OK)
        return st;
    *served = a.served;
    return anchor_announce(path, t->vault, end, e);
}

/* What is under the next vault: the subjects' keys, or everything. */
static enum status write_rows(struct store_txn *t, const struct store_act *by,
                              const struct store_rekey *to, const struct vault *next,
                              struct errinfo *e)
{
    static const char *const word[] = {"plaintext", "file", "passphrase"};
    enum status st;

    if (to->compromised)
        return store_renew(t, by, next, word[to->kind], e);
    st = wrap_all(t, next, e);
    return st == ST_OK ? row_event_add(t, by, "rekey", "", "", word[to->kind], e) : st;
}

/* The database's part, as one transaction.  *plain: it was plaintext before. */
static enum status change(struct store *s, const struct store_act *by,
                          const struct store_rekey *to, struct files *f, bool *plain,
                          struct errinfo *e)
{
    struct vault_root from, root;
    struct vault *next = NULL;
    const struct vault *before;
    struct anchor_end end;
    struct store_txn t;
    struct errinfo why;
    bool served = false;
    enum status st, committed;

    if ((st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    before = t.vault;
    if ((st = store_vault_read(t.sql, &from, e)) == ST_OK &&
        (st = settle(f, &from, to, e)) == ST_OK &&
        (st = make_vault(&t, to, &from, f, &root, &next, e)) == ST_OK &&
        (st = write_rows(&t, by, to, next, e)) == ST_OK &&
        (st = store_vault_write(t.sql, &root, e)) == ST_OK &&
        (!to->compromised || (st = announce(&t, before, &end, &served, e)) == ST_OK))
        st = set_aside(f, e);
    *plain = st == ST_OK && from.kind == VAULT_PLAINTEXT;
    committed = store_txn_end(&t, st, &why);
    if (committed == ST_OK && to->compromised && s->anchor.path != NULL)
        (void)anchor_set(s->anchor.path, next, &end, served, NULL);
    if (committed == ST_OK)
        return store_vault_keep(&s->vaults, next, &root, e);
    if (st == ST_OK) /* it may be on the disk all the same */
        st = errinfo_set(e, committed, "%.150s%s%.90s", why.msg,
                         f->made || f->aside ? "; keep " : "",
                         f->made || f->aside ? f->next : "");
    else
        take_back(f);
    vault_free(next);
    return st;
}

/* The new key in its place, the old one out of it. */
static enum status place(const struct files *f, bool keep, struct errinfo *e)
{
    struct errinfo why;
    enum status st = ST_OK;

    if (f->fits && keep)
        st = keyfile_move(f->aside ? f->next : f->key, f->old, &why);
    else if (f->aside && unlink(f->next) != 0)
        st = errinfo_set(&why, ST_EIO, "%.160s cannot be removed", f->next);
    if (st == ST_OK && f->made)
        st = keyfile_move(f->next, f->key, &why);
    return st == ST_OK ? st : errinfo_set(e, st, "the key was changed, but %s", why.msg);
}

enum status store_rekey(struct store *s, const char *actor, const struct store_rekey *to,
                        struct errinfo *e)
{
    struct files f = {0};
    struct store_act by;
    struct errinfo why;
    bool plain = false;
    int lock = -1;
    enum status st;

    if ((to->kind == VAULT_PASSPHRASE && to->given == NULL) ||
        (to->kind == VAULT_PLAINTEXT && to->given != NULL))
        return errinfo_set(e, ST_EINVAL, "a key of another kind");
    if (to->kind == VAULT_PASSPHRASE && !to->weak &&
        (st = keyfile_strong(to->given, e)) != ST_OK)
        return st;
    if ((st = name_files(&s->vaults, to, &f, e)) == ST_OK &&
        (st = keyfile_lock(s->vaults.path, &lock, e)) == ST_OK &&
        (!to->compromised || ((st = settle_now(s, &f, to, e)) == ST_OK &&
                              (st = store_renew_subjects(s, actor, e)) == ST_OK)) &&
        (st = store_rules_act(&by, actor, e)) == ST_OK &&
        (st = change(s, &by, to, &f, &plain, e)) == ST_OK)
        st = place(&f, to->keep, e);
    if (lock >= 0)
        (void)close(lock);
    free(f.next);
    free(f.old);
    if (st == ST_OK && plain && (st = sql_file_compact(s->sql, &why)) != ST_OK)
        (void)errinfo_set(e, st, "the key was changed, but the old one may be left: %s",
                          why.msg);
    store_txn_scrub(s);
    return st;
}
