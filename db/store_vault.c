/* Read when the database is opened, and again when another process has changed the key. */
#include "store_vault.h"

#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "keyfile.h"
#include "sql.h"
#include "store_column.h"

enum status store_vault_init(struct store_vaults *v, const char *db,
                             const struct store_key *key, struct errinfo *e)
{
    const char *of = key->of != NULL ? key->of : db;
    const size_t n = strlen(of) + sizeof ".key";

    memset(v, 0, sizeof *v);
    v->db = db;
    v->given = key->given;
    v->plaintext = key->plaintext;
    v->weak = key->weak;
    v->make = key->make;
    (void)pthread_mutex_init(&v->lock, NULL);
    if (key->path != NULL)
        v->path = strdup(key->path);
    else if ((v->path = malloc(n)) != NULL)
        (void)snprintf(v->path, n, "%s.key", of);
    return v->path != NULL ? ST_OK : errinfo_set(e, ST_ENOMEM, "out of memory");
}

void store_vault_free(struct store_vaults *v)
{
    for (struct store_vault *k = v->newest, *older; k != NULL; k = older) {
        older = k->older;
        vault_free(k->vault);
        free(k);
    }
    (void)pthread_mutex_destroy(&v->lock);
    free(v->path);
}

/* ---- the row */

enum status store_vault_read(struct sql_txn *t, struct vault_root *r, struct errinfo *e)
{
    struct sql_rows *row;
    uint32_t kind = 0;
    enum status st = sql_query(
        t,
        "SELECT kind, version, passes, mib, salt, plaintext, public, secrets, mac FROM root",
        NULL, 0, &row, e);

    memset(r, 0, sizeof *r);
    if (st == ST_OK && sql_next(row)) {
        if (!store_column_count(row, 0, VAULT_PASSPHRASE, &kind) ||
            !store_column_int(row, 1, 1, &r->version) ||
            !store_column_count(row, 2, UINT32_MAX, &r->passes) ||
            !store_column_count(row, 3, UINT32_MAX, &r->mib) ||
            !store_column_bytes(row, 4, r->salt, sizeof r->salt) ||
            !store_column_bytes(row, 5, r->plaintext, sizeof r->plaintext) ||
            !store_column_bytes(row, 6, r->public, sizeof r->public) ||
            !store_column_bytes(row, 7, r->secrets, sizeof r->secrets) ||
            !store_column_bytes(row, 8, r->mac, sizeof r->mac))
            st = errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
        r->kind = (enum vault_kind)kind;
        return sql_done(row, st, e);
    }
    if ((st = sql_done(row, st, e)) == ST_OK)
        st = errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
    return st;
}

enum status store_vault_write(struct sql_txn *t, const struct vault_root *r,
                              struct errinfo *e)
{
    return SQL_RUN(
        t, e,
        "INSERT INTO root (root_key, kind, version, passes, mib, salt, plaintext, public, "
        "secrets, mac) VALUES (1, $1, $2, $3, $4, $5, $6, $7, $8, $9) "
        "ON CONFLICT (root_key) DO UPDATE SET kind = excluded.kind, "
        "version = excluded.version, passes = excluded.passes, mib = excluded.mib, "
        "salt = excluded.salt, plaintext = excluded.plaintext, public = excluded.public, "
        "secrets = excluded.secrets, mac = excluded.mac",
        sql_int((int64_t)r->kind), sql_int(r->version), sql_int(r->passes),
        sql_int(r->mib), sql_blob(r->salt, sizeof r->salt),
        sql_blob(r->plaintext, sizeof r->plaintext),
        sql_blob(r->public, sizeof r->public), sql_blob(r->secrets, sizeof r->secrets),
        sql_blob(r->mac, sizeof r->mac));
}

/* ---- opening */

static enum status open_by_file(const char *path, const struct vault_root *r,
                                struct vault **out, struct errinfo *e)
{
    struct keyfile *k;
    enum status st = keyfile_read(path, &k, e);

    if (st != ST_OK)
        return st;
    st = keyfile_open(k, path, r, out, e);
    keyfile_free(k);
    return st;
}

bool store_vault_fits(const char *path, const struct vault_root *r)
{
    struct vault *vault = NULL;
    const bool fits =
        r->kind != VAULT_PLAINTEXT && open_by_file(path, r, &vault, NULL) == ST_OK;

    vault_free(vault);
    return fits;
}

/* Another process may have changed the key and not put it in its place yet, or just now. */
static enum status open_by_files(const char *path, const struct vault_root *r,
                                 struct vault **out, struct errinfo *e)
{
    const size_t n = strlen(path) + sizeof ".new";
    enum status st = open_by_file(path, r, out, e);
    char *next;

    if (st != ST_EDENIED && st != ST_ENOTFOUND && st != ST_EINVAL)
        return st;
    if ((next = malloc(n)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(next, n, "%s.new", path);
    if (open_by_file(next, r, out, NULL) == ST_OK)
        st = ST_OK;
    else
        st = open_by_file(path, r, out, e);
    free(next);
    return st;
}

/* A plaintext root carries its own master key, so that a process which can write the file can make
 * one.  It is accepted only where the operator says that the database is plaintext, and only it. */
static enum status check_kind(const struct store_vaults *v, enum vault_kind kind,
                              struct errinfo *e)
{
    if (kind == VAULT_PLAINTEXT && !v->plaintext)
        return errinfo_set(
            e, ST_EDENIED,
            "%.100s is plaintext: restore a backup; or, if it is meant to be "
            "plaintext, say so with --plaintext-database",
            v->db);
    if (kind != VAULT_PLAINTEXT && v->plaintext)
        return errinfo_set(e, ST_EDENIED,
                           "%.100s is encrypted: it takes no --plaintext-database",
                           v->db);
    return ST_OK;
}

static enum status open_root(const struct store_vaults *v, const struct vault_root *r,
                             struct vault **out, struct errinfo *e)
{
    if (r->kind == VAULT_PLAINTEXT)
        return vault_open(r, NULL, 0, out, e);
    if (v->given != NULL)
        return keyfile_open(v->given, "the key", r, out, e);
    return open_by_files(v->path, r, out, e);
}

/* ---- which of them */

static bool same_root(const struct vault_root *a, const struct vault_root *b)
{
    return a->kind == b->kind && a->version == b->version && a->passes == b->passes &&
           a->mib == b->mib && memcmp(a->salt, b->salt, sizeof a->salt) == 0 &&
           memcmp(a->plaintext, b->plaintext, sizeof a->plaintext) == 0 &&
           memcmp(a->public, b->public, sizeof a->public) == 0 &&
           memcmp(a->secrets, b->secrets, sizeof a->secrets) == 0 &&
           memcmp(a->mac, b->mac, sizeof a->mac) == 0;
}

/* Those before the newest are wiped when nothing uses them any more.  In v's lock. */
static void wipe_unused(struct store_vaults *v)
{
    struct store_vault **at = v->newest != NULL ? &v->newest->older : &v->newest, *k;

    while ((k = *at) != NULL) {
        if (k->users > 0) {
            at = &k->older;
            continue;
        }
        *at = k->older;
        vault_free(k->vault);
        free(k);
    }
}

/* In v's lock.  Another thread may have been faster. */
static enum status keep(struct store_vaults *v, struct vault *vault,
                        const struct vault_root *root, struct errinfo *e)
{
    struct store_vault *k;

    if (v->newest != NULL && v->newest->root.version >= root->version) {
        vault_free(vault);
        return ST_OK;
    }
    if ((k = calloc(1, sizeof *k)) == NULL) {
        vault_free(vault);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    *k = (struct store_vault){.vault = vault, .root = *root, .older = v->newest};
    v->newest = k;
    v->failed_s = 0;
    wipe_unused(v);
    return ST_OK;
}

enum status store_vault_keep(struct store_vaults *v, struct vault *vault,
                             const struct vault_root *root, struct errinfo *e)
{
    enum status st;

    pthread_mutex_lock(&v->lock);
    st = keep(v, vault, root, e);
    pthread_mutex_unlock(&v->lock);
    return st;
}

struct store_vault *store_vault_take(struct store_vaults *v)
{
    struct store_vault *k;

    pthread_mutex_lock(&v->lock);
    if ((k = v->newest) != NULL)
        k->users++;
    pthread_mutex_unlock(&v->lock);
    return k;
}

void store_vault_release(struct store_vaults *v, struct store_vault *held)
{
    if (held == NULL)
        return;
    pthread_mutex_lock(&v->lock);
    if (--held->users == 0 && held != v->newest)
        wipe_unused(v);
    pthread_mutex_unlock(&v->lock);
}

static int64_t now_s(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1; /* never 0 */
}

/* A root that no transaction has seen before.  A key that does not open it is not tried with each
 * transaction, since that may cost an Argon2id.  In v's lock. */
static enum status learn(struct store_vaults *v, const struct vault_root *root,
                         struct errinfo *e)
{
    const int64_t now = now_s();
    struct errinfo why;
    struct vault *vault;
    enum status st;

    if (v->failed_s != 0 && now - v->failed_s < 2)
        return errinfo_set(e, v->failed.code, "%s", v->failed.msg);
    v->failed_s = 0;
    if ((st = open_root(v, root, &vault, &why)) == ST_OK)
        return keep(v, vault, root, e);
    if (st == ST_EDENIED || st == ST_ENOTFOUND || st == ST_EINVAL) {
        v->failed_s = now;
        v->failed = why;
    }
    return errinfo_set(e, st, "%s", why.msg);
}

static struct store_vault *find(const struct store_vaults *v,
                                const struct vault_root *root)
{
    struct store_vault *k = v->newest;

    while (k != NULL && !same_root(&k->root, root))
        k = k->older;
    return k;
}

/* The newest was taken before the transaction began, so that the root is as new at least. */
static enum status check_next(const struct store_vault *held,
                              const struct vault_root *root, struct errinfo *e)
{
    if (root->version <= held->root.version)
        return errinfo_set(
            e, ST_EREFUSED, "the database was replaced: its key record is %s",
            root->version < held->root.version ? "older than the one that was in use"
                                               : "not the one that was in use");
    if (!vault_follows(held->vault, root))
        return errinfo_set(
            e, ST_EREFUSED,
            "the database was replaced, or its key changed without the old "
            "one: the new key record is not authenticated by the old key");
    return ST_OK;
}

enum status store_vault_use(struct store_vaults *v, struct sql_txn *t,
                            struct store_vault **held, struct errinfo *e)
{
    struct store_vault *const was = *held;
    struct vault_root root;
    enum status st;

    if ((st = store_vault_read(t, &root, e)) != ST_OK ||
        (was != NULL && same_root(&was->root, &root)))
        return st;
    st = was == NULL ? check_kind(v, root.kind, e) : check_next(was, &root, e);
    if (st != ST_OK)
        return st;
    pthread_mutex_lock(&v->lock);
    if ((*held = find(v, &root)) == NULL && (st = learn(v, &root, e)) == ST_OK)
        *held = find(v, &root);
    if (*held != NULL)
        (*held)->users++;
    pthread_mutex_unlock(&v->lock);
    store_vault_release(v, was);
    if (st == ST_OK && *held == NULL) /* another process changes it again and again */
        st = errinfo_set(e, ST_EBUSY, "the database's key was changed meanwhile");
    return st;
}

/* ---- a first key */

static enum status make_by_phrase(const struct store_vaults *v, const struct keyfile *k,
                                  struct vault_root *r, struct vault **out,
                                  struct errinfo *e)
{
    const enum status st = v->weak ? ST_OK : keyfile_strong(k, e);

    return st == ST_OK ? vault_make(v->make, k->text, k->len, r, out, e) : st;
}

/* The root of a database that had none, by a key's file that is there, or is made. */
static enum status make_root(struct store_vaults *v, struct vault_root *r,
                             struct vault **out, struct errinfo *e)
{
    unsigned char key[VAULT_KEY];
    struct keyfile *k = NULL;
    enum status st;

    if (v->make == VAULT_PLAINTEXT) {
        if (access(v->path, F_OK) == 0)
            return errinfo_set(
                e, ST_EDENIED,
                "there is a key %.160s: move it away if the database is meant "
                "to be plaintext",
                v->path);
        return vault_make(v->make, NULL, 0, r, out, e);
    }
    if (v->make == VAULT_PASSPHRASE && v->given != NULL)
        return make_by_phrase(v, v->given, r, out, e);
    if ((st = keyfile_read(v->path, &k, e)) == ST_ENOTFOUND && v->make == VAULT_FILE &&
        (st = keyfile_make(v->path, e)) == ST_OK) {
        v->made = true;
        st = keyfile_read(v->path, &k, e);
    }
    if (st == ST_OK && v->make == VAULT_PASSPHRASE)
        st = make_by_phrase(v, k, r, out, e);
    else if (st == ST_OK && (st = keyfile_key(k, v->path, key, e)) == ST_OK)
        st = vault_make(v->make, key, sizeof key, r, out, e);
    sodium_memzero(key, sizeof key);
    keyfile_free(k);
    return st;
}

enum status store_vault_new(struct store_vaults *v, struct sql_txn *t,
                            struct store_vault **held, struct errinfo *e)
{
    struct vault_root root;
    struct vault *vault;
    enum status st;

    if ((st = make_root(v, &root, &vault, e)) != ST_OK ||
        (st = store_vault_keep(v, vault, &root, e)) != ST_OK)
        return st;
    *held = store_vault_take(v);
    return store_vault_write(t, &root, e);
}

void store_vault_undo(struct store_vaults *v)
{
    if (v->made)
        (void)unlink(v->path);
    v->made = false;
}
