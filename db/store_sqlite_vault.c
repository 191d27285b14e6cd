/* Keys: read when the database is opened, and again when another process has changed them. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "errinfo.h"
#include "keyfile.h"
#include "store_sqlite.h"

enum status store_sqlite_vault_init(struct store_sqlite_vaults *v, const char *db,
                                    const struct store_key *key, struct errinfo *e)
{
    const char *of = key->of != NULL ? key->of : db;
    const size_t n = strlen(of) + sizeof ".key";

    memset(v, 0, sizeof *v);
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

void store_sqlite_vault_free(struct store_sqlite_vaults *v)
{
    for (int i = 0; i < v->n; i++)
        vault_free(v->list[i]);
    (void)pthread_mutex_destroy(&v->lock);
    free(v->path);
}

/* ---- the row */

enum status store_sqlite_vault_read(struct store_sqlite_conn *c, struct vault_root *r,
                                    struct errinfo *e)
{
    sqlite3_stmt *stmt;
    uint32_t kind = 0;
    enum status st = store_sqlite_prepare(c, SQL_ROOT_GET, &stmt, e);
    int rc;

    memset(r, 0, sizeof *r);
    if (st != ST_OK)
        return st;
    if ((rc = sqlite3_step(stmt)) != SQLITE_ROW && rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the key record", e);
    else if (rc == SQLITE_DONE || !store_sqlite_count(stmt, 0, VAULT_PASSPHRASE, &kind) ||
             (r->version = sqlite3_column_int64(stmt, 1)) < 1 ||
             !store_sqlite_count(stmt, 2, UINT32_MAX, &r->passes) ||
             !store_sqlite_count(stmt, 3, UINT32_MAX, &r->mib) ||
             !store_sqlite_bytes(stmt, 4, r->salt, sizeof r->salt) ||
             !store_sqlite_bytes(stmt, 5, r->open, sizeof r->open) ||
             !store_sqlite_bytes(stmt, 6, r->public, sizeof r->public) ||
             !store_sqlite_bytes(stmt, 7, r->secrets, sizeof r->secrets))
        st = errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
    r->kind = (enum vault_kind)kind;
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_vault_kind(struct store_sqlite_conn *c, enum vault_kind *kind,
                                    struct errinfo *e)
{
    struct vault_root root;
    const enum status st = store_sqlite_vault_read(c, &root, e);

    *kind = root.kind;
    return st;
}

enum status store_sqlite_vault_write(struct store_sqlite_conn *c,
                                     const struct vault_root *r, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_ROOT_SET, &stmt, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, (sqlite3_int64)r->kind) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 2, r->version) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 3, r->passes) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 4, r->mib) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 5, r->salt, sizeof r->salt) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 6, r->open, sizeof r->open) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 7, r->public, sizeof r->public) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 8, r->secrets, sizeof r->secrets) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot write the key record", e);
    return store_sqlite_run(c, stmt, e);
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

bool store_sqlite_vault_fits(const char *path, const struct vault_root *r)
{
    struct vault *vault = NULL;
    const bool fits =
        r->kind != VAULT_OPEN && open_by_file(path, r, &vault, NULL) == ST_OK;

    vault_free(vault);
    return fits;
}

/* Somebody may have changed the key and not put it in its place yet, or just now. */
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

/* A plaintext root carries its own master key, so anybody who can write the file can make
 * one.  It is accepted only where nothing says that the database has a key. */
static enum status allow_plaintext(const struct store_sqlite_vaults *v, const char *db,
                                   struct errinfo *e)
{
    if (v->given != NULL)
        return errinfo_set(e, ST_EDENIED,
                           "%.100s is plaintext, but a passphrase is given: restore a "
                           "backup, or give none if it is meant to be plaintext",
                           db);
    if (v->named)
        return errinfo_set(e, ST_EDENIED,
                           "%.60s is plaintext, but the key %.60s is given: restore a "
                           "backup, or give no key if it is meant to be plaintext",
                           db, v->path);
    if (access(v->path, F_OK) == 0 || errno != ENOENT)
        return errinfo_set(e, ST_EDENIED,
                           "%.60s is plaintext, but there is a key %.60s: restore a "
                           "backup, or move the key away if it is meant to be plaintext",
                           db, v->path);
    return ST_OK;
}

static enum status open_root(const struct store_sqlite_vaults *v,
                             struct store_sqlite_conn *c, const struct vault_root *r,
                             struct vault **out, struct errinfo *e)
{
    enum status st;

    if (r->kind == VAULT_OPEN) {
        st = allow_plaintext(v, sqlite3_db_filename(c->db, "main"), e);
        return st == ST_OK ? vault_open(r, NULL, 0, out, e) : st;
    }
    if (v->given != NULL)
        return keyfile_open(v->given, "the key", r, out, e);
    return open_by_files(v->path, r, out, e);
}

static enum status root_version(struct store_sqlite_conn *c, int64_t *version,
                                struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_ROOT_VERSION, &stmt, e);
    int rc;

    *version = 0;
    if (st != ST_OK)
        return st;
    if ((rc = sqlite3_step(stmt)) == SQLITE_ROW)
        *version = sqlite3_column_int64(stmt, 0);
    else if (rc == SQLITE_DONE)
        st = errinfo_set(e, ST_ECORRUPT, "the database's key record is missing");
    else
        st = store_sqlite_fail(c, "cannot read the key record", e);
    (void)sqlite3_reset(stmt);
    return st;
}

/* In v's lock, or before other threads use v. */
static enum status keep(struct store_sqlite_vaults *v, struct vault *vault,
                        struct errinfo *e)
{
    if (v->n == STORE_SQLITE_VAULTS) {
        vault_free(vault);
        return errinfo_set(e, ST_ELIMIT, "the key was changed too often: start again");
    }
    v->list[v->n++] = vault;
    return ST_OK;
}

enum status store_sqlite_vault_keep(struct store_sqlite_vaults *v, struct vault *vault,
                                    struct errinfo *e)
{
    enum status st;

    pthread_mutex_lock(&v->lock);
    st = keep(v, vault, e);
    pthread_mutex_unlock(&v->lock);
    return st;
}

enum status store_sqlite_vault_use(struct store_sqlite_vaults *v,
                                   struct store_sqlite_conn *c, struct errinfo *e)
{
    struct vault_root root;
    struct vault *vault;
    int64_t version;
    enum status st;

    if ((st = root_version(c, &version, e)) != ST_OK ||
        (c->vault != NULL && vault_version(c->vault) == version))
        return st;
    pthread_mutex_lock(&v->lock);
    c->vault = NULL;
    for (int i = 0; i < v->n; i++)
        if (vault_version(v->list[i]) == version)
            c->vault = v->list[i];
    if (c->vault == NULL && (st = store_sqlite_vault_read(c, &root, e)) == ST_OK &&
        (st = open_root(v, c, &root, &vault, e)) == ST_OK &&
        (st = keep(v, vault, e)) == ST_OK)
        c->vault = vault;
    pthread_mutex_unlock(&v->lock);
    return st;
}

/* ---- a first key */

/* The root of a database that had none, by a key's file that is there, or is made. */
static enum status make_root(struct store_sqlite_vaults *v, struct store_sqlite_conn *c,
                             struct vault_root *r, struct vault **out, struct errinfo *e)
{
    unsigned char key[VAULT_KEY];
    struct keyfile *k = NULL;
    enum status st;

    if (v->make == VAULT_OPEN) {
        st = allow_plaintext(v, sqlite3_db_filename(c->db, "main"), e);
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

enum status store_sqlite_vault_new(struct store_sqlite_vaults *v,
                                   struct store_sqlite_conn *c, struct errinfo *e)
{
    struct vault_root root;
    struct vault *vault;
    enum status st;

    if ((st = make_root(v, c, &root, &vault, e)) != ST_OK ||
        (st = keep(v, vault, e)) != ST_OK)
        return st;
    c->vault = vault;
    return store_sqlite_vault_write(c, &root, e);
}

void store_sqlite_vault_undo(struct store_sqlite_vaults *v)
{
    if (v->made)
        (void)unlink(v->path);
    v->made = false;
}
