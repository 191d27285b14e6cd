/* Read when the database is opened, and again when another process has changed the key. */
#include "store_vault.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "errinfo.h"
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
    v->named = key->path != NULL;
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
    for (int i = 0; i < v->n; i++)
        vault_free(v->list[i]);
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
        "SELECT kind, version, passes, mib, salt, plaintext, public, secrets FROM root",
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
            !store_column_bytes(row, 7, r->secrets, sizeof r->secrets))
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
        "secrets) VALUES (1, $1, $2, $3, $4, $5, $6, $7, $8) "
        "ON CONFLICT (root_key) DO UPDATE SET kind = excluded.kind, "
        "version = excluded.version, passes = excluded.passes, mib = excluded.mib, "
        "salt = excluded.salt, plaintext = excluded.plaintext, public = excluded.public, "
        "secrets = excluded.secrets",
        sql_int((int64_t)r->kind), sql_int(r->version), sql_int(r->passes),
        sql_int(r->mib), sql_blob(r->salt, sizeof r->salt),
        sql_blob(r->plaintext, sizeof r->plaintext),
        sql_blob(r->public, sizeof r->public), sql_blob(r->secrets, sizeof r->secrets));
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
 * one.  It is accepted only where nothing says that the database has a key. */
static enum status allow_plaintext(const struct store_vaults *v, struct errinfo *e)
{
    if (v->given != NULL)
        return errinfo_set(e, ST_EDENIED,
                           "%.100s is plaintext, but a passphrase is given: restore a "
                           "backup, or give none if it is meant to be plaintext",
                           v->db);
    if (v->named)
        return errinfo_set(e, ST_EDENIED,
                           "%.60s is plaintext, but the key %.60s is given: restore a "
                           "backup, or give no key if it is meant to be plaintext",
                           v->db, v->path);
    if (access(v->path, F_OK) == 0 || errno != ENOENT)
        return errinfo_set(e, ST_EDENIED,
                           "%.60s is plaintext, but there is a key %.60s: restore a "
                           "backup, or move the key away if it is meant to be plaintext",
                           v->db, v->path);
    return ST_OK;
}

static enum status open_root(const struct store_vaults *v, const struct vault_root *r,
                             struct vault **out, struct errinfo *e)
{
    enum status st;

    if (r->kind == VAULT_PLAINTEXT) {
        st = allow_plaintext(v, e);
        return st == ST_OK ? vault_open(r, NULL, 0, out, e) : st;
    }
    if (v->given != NULL)
        return keyfile_open(v->given, "the key", r, out, e);
    return open_by_files(v->path, r, out, e);
}

static enum status root_version(struct sql_txn *t, int64_t *version, struct errinfo *e)
{
    struct sql_rows *row;
    enum status st = sql_query(t, "SELECT version FROM root", NULL, 0, &row, e);

    *version = 0;
    if (st == ST_OK && sql_next(row))
        *version = sql_column(row, 0).i;
    if ((st = sql_done(row, st, e)) == ST_OK && *version == 0)
        st = errinfo_set(e, ST_ECORRUPT, "the database's key record is missing");
    return st;
}

/* In v's lock, or before other threads use v. */
static enum status keep(struct store_vaults *v, struct vault *vault, struct errinfo *e)
{
    if (v->n == STORE_VAULT_MAX) {
        vault_free(vault);
        return errinfo_set(e, ST_ELIMIT, "the key was changed too often: start again");
    }
    v->list[v->n++] = vault;
    return ST_OK;
}

enum status store_vault_keep(struct store_vaults *v, struct vault *vault,
                             struct errinfo *e)
{
    enum status st;

    pthread_mutex_lock(&v->lock);
    st = keep(v, vault, e);
    pthread_mutex_unlock(&v->lock);
    return st;
}

enum status store_vault_use(struct store_vaults *v, struct sql_txn *t,
                            const struct vault **out, struct errinfo *e)
{
    struct vault_root root;
    struct vault *vault;
    int64_t version;
    enum status st;

    *out = NULL;
    if ((st = root_version(t, &version, e)) != ST_OK)
        return st;
    pthread_mutex_lock(&v->lock);
    for (int i = 0; i < v->n; i++)
        if (vault_version(v->list[i]) == version)
            *out = v->list[i];
    if (*out == NULL && (st = store_vault_read(t, &root, e)) == ST_OK &&
        (st = open_root(v, &root, &vault, e)) == ST_OK &&
        (st = keep(v, vault, e)) == ST_OK)
        *out = vault;
    pthread_mutex_unlock(&v->lock);
    return st;
}

/* ---- a first key */

/* The root of a database that had none, by a key's file that is there, or is made. */
static enum status make_root(struct store_vaults *v, struct vault_root *r,
                             struct vault **out, struct errinfo *e)
{
    unsigned char key[VAULT_KEY];
    struct keyfile *k = NULL;
    enum status st;

    if (v->make == VAULT_PLAINTEXT) {
        st = allow_plaintext(v, e);
        return st == ST_OK ? vault_make(v->make, NULL, 0, r, out, e) : st;
    }
    if (v->make == VAULT_PASSPHRASE && v->given != NULL)
        return vault_make(v->make, v->given->text, v->given->len, r, out, e);
    if ((st = keyfile_read(v->path, &k, e)) == ST_ENOTFOUND && v->make == VAULT_FILE &&
        (st = keyfile_make(v->path, e)) == ST_OK) {
        v->made = true;
        st = keyfile_read(v->path, &k, e);
    }
    if (st == ST_OK && v->make == VAULT_PASSPHRASE)
        st = vault_make(v->make, k->text, k->len, r, out, e);
    else if (st == ST_OK && (st = keyfile_key(k, v->path, key, e)) == ST_OK)
        st = vault_make(v->make, key, sizeof key, r, out, e);
    sodium_memzero(key, sizeof key);
    keyfile_free(k);
    return st;
}

enum status store_vault_new(struct store_vaults *v, struct sql_txn *t,
                            const struct vault **out, struct errinfo *e)
{
    struct vault_root root;
    struct vault *vault;
    enum status st;

    if ((st = make_root(v, &root, &vault, e)) != ST_OK ||
        (st = store_vault_keep(v, vault, e)) != ST_OK)
        return st;
    *out = vault;
    return store_vault_write(t, &root, e);
}

void store_vault_undo(struct store_vaults *v)
{
    if (v->made)
        (void)unlink(v->path);
    v->made = false;
}
