/* What the database's tables are: is it this program's, of which version, made, upgraded,
 * compared. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "errinfo.h"
#include "newfile.h"
#include "schema_sql.h"
#include "store_rules.h"
#include "store_sqlite.h"

#define APPLICATION 0x53524644 /* application_id in schema.sql */

/* The value of a one-row query of one integer. */
static enum status query_int(struct store_sqlite_conn *c, const char *sql, int64_t *out,
                             struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;

    if (sqlite3_prepare_v2(c->db, sql, -1, &stmt, NULL) != SQLITE_OK ||
        sqlite3_step(stmt) != SQLITE_ROW)
        st = store_sqlite_fail(c, "cannot read", e);
    else
        *out = sqlite3_column_int64(stmt, 0);
    (void)sqlite3_finalize(stmt);
    return st;
}

enum status store_sqlite_size(struct store_sqlite_conn *c, uint64_t *bytes,
                              struct errinfo *e)
{
    int64_t pages = 0, size = 0;
    enum status st;

    if ((st = query_int(c, "PRAGMA page_count", &pages, e)) == ST_OK &&
        (st = query_int(c, "PRAGMA page_size", &size, e)) == ST_OK)
        *bytes = (uint64_t)pages * (uint64_t)size;
    return st;
}

enum status store_sqlite_schema_version(struct store_sqlite_conn *c, const char *path,
                                        int *version, struct errinfo *e)
{
    int64_t application = 0, user = 0, objects = 0;
    enum status st;

    *version = 0;
    if ((st = query_int(c, "PRAGMA application_id", &application, e)) != ST_OK ||
        (st = query_int(c, "PRAGMA user_version", &user, e)) != ST_OK ||
        (st = query_int(c, "SELECT count(*) FROM sqlite_schema", &objects, e)) != ST_OK)
        return st;
    if (application == 0 && user == 0 && objects == 0)
        return ST_OK;
    if (application != APPLICATION)
        return errinfo_set(e, ST_ECORRUPT, "%s is the database of another program", path);
    if (user > STORE_SQLITE_SCHEMA)
        return errinfo_set(e, ST_EVERSION,
                           "%s has schema version %lld, this program knows up to %d: "
                           "use a newer program",
                           path, (long long)user, STORE_SQLITE_SCHEMA);
    if (user < 1)
        return errinfo_set(e, ST_ECORRUPT, "%s has the impossible schema version %lld",
                           path, (long long)user);
    *version = (int)user;
    return ST_OK;
}

/* The statements of schema.sql that lead from a version to the newest; NULL: none do. */
static const char *steps_from(int version)
{
    char mark[32];

    if (version == 0)
        return schema_sql;
    (void)snprintf(mark, sizeof mark, "\n-- version %d\n", version + 1);
    return strstr(schema_sql, mark);
}

/* A database has its first key: by whom is not known here. */
static enum status tell_key(const struct store_sqlite_vaults *v,
                            struct store_sqlite_conn *c, struct errinfo *e)
{
    static const char *const kept[] = {[VAULT_OPEN] = "plaintext",
                                       [VAULT_FILE] = "file",
                                       [VAULT_PASSPHRASE] = "passphrase"};
    struct store_act by;
    const enum status st = store_rules_act(&by, "", e);

    return st != ST_OK
               ? st
               : store_sqlite_event_add(c, &by, "create_key", "", "", kept[v->make], e);
}

/* Run the steps from a version on, inside a transaction.  Rows of version 3 become those
 * of 4 at the line that says so: that takes a key. */
static enum status run_steps(struct store_sqlite_conn *c, struct store_sqlite_vaults *v,
                             const char *path, int version, struct errinfo *e)
{
    static const char mark[] = "\n-- convert\n";
    const char *steps = steps_from(version), *what, *turn;
    char *first;
    enum status st;

    if (steps == NULL)
        return errinfo_set(e, ST_EVERSION, "%s has schema version %d: no way leads to %d",
                           path, version, STORE_SQLITE_SCHEMA);
    if ((turn = strstr(steps, mark)) == NULL ||
        (first = strndup(steps, (size_t)(turn - steps))) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    what = version == 0 ? "cannot create the tables" : "cannot upgrade the tables";
    if (sqlite3_exec(c->db, first, NULL, NULL, NULL) != SQLITE_OK)
        st = store_sqlite_fail(c, what, e);
    else if ((st = store_sqlite_vault_new(v, c, e)) == ST_OK &&
             (st = store_sqlite_event_begin(c, e)) == ST_OK &&
             (st = store_sqlite_convert(c, e)) == ST_OK &&
             (st = tell_key(v, c, e)) == ST_OK &&
             sqlite3_exec(c->db, turn, NULL, NULL, NULL) != SQLITE_OK)
        st = store_sqlite_fail(c, what, e);
    free(first);
    return st;
}

/* The steps from a version on, and with them a backup of what there was, or neither: it gets
 * its name when the steps have been gone and before they count. */
static enum status upgrade(struct store_sqlite_conn *c, struct store_sqlite_vaults *v,
                           const char *path, int version, struct errinfo *e)
{
    struct newfile old = NEWFILE_NONE;
    enum status st = ST_OK;

    if (version > 0)
        st = store_sqlite_backup_old(path, version, &old, e);
    if (st == ST_OK)
        st = run_steps(c, v, path, version, e);
    if (st == ST_OK && version > 0)
        st = newfile_commit(&old, e);
    if (st == ST_OK && sqlite3_exec(c->db, "COMMIT", NULL, NULL, NULL) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot write", e);
        if (version > 0)
            (void)unlink(old.path);
    }
    newfile_close(&old);
    return st;
}

enum status store_sqlite_schema_make(struct store_sqlite_conn *c,
                                     struct store_sqlite_vaults *v, const char *path,
                                     struct errinfo *e)
{
    int version;
    enum status st;

    /* What is dropped is overwritten.  Large pages, in a new file: a template of 79 KB is five
     * of them one after the other, not twenty, which a disk notices (docs/database.md). */
    if (sqlite3_exec(c->db,
                     "PRAGMA page_size=16384; PRAGMA journal_mode=WAL;"
                     "PRAGMA secure_delete=ON; BEGIN EXCLUSIVE",
                     NULL, NULL, NULL) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot initialise", e);
    /* Again, now that nobody can change it: another process may just have done the work. */
    if ((st = store_sqlite_schema_version(c, path, &version, e)) == ST_OK &&
        version < STORE_SQLITE_SCHEMA)
        st = upgrade(c, v, path, version, e);
    if (!sqlite3_get_autocommit(c->db))
        (void)sqlite3_exec(c->db, "ROLLBACK", NULL, NULL, NULL);
    if (st != ST_OK)
        store_sqlite_vault_undo(v);
    return st;
}

#define SCHEMA_ROWS                                                                      \
    "SELECT type, name, tbl_name, sql FROM sqlite_schema "                               \
    "WHERE name NOT GLOB 'sqlite_stat*' ORDER BY type, name"

/* Do two databases have the same schema, word for word? */
static enum status same_schema(struct store_sqlite_conn *c, sqlite3 *model, bool *same,
                               struct errinfo *e)
{
    sqlite3_stmt *a = NULL, *b = NULL;
    enum status st = ST_OK;
    int ra, rb;

    *same = true;
    if (sqlite3_prepare_v2(c->db, SCHEMA_ROWS, -1, &a, NULL) != SQLITE_OK) {
        st = store_sqlite_fail(c, "cannot check", e);
        goto out;
    }
    if (sqlite3_prepare_v2(model, SCHEMA_ROWS, -1, &b, NULL) != SQLITE_OK) {
        st = errinfo_set(e, ST_EDB, "cannot check: %s", sqlite3_errmsg(model));
        goto out;
    }
    do {
        ra = sqlite3_step(a);
        rb = sqlite3_step(b);
        if (ra != rb)
            *same = false;
        for (int i = 0; *same && ra == SQLITE_ROW && i < 4; i++) {
            const int n = sqlite3_column_bytes(a, i);

            *same = n == sqlite3_column_bytes(b, i) &&
                    (n == 0 || memcmp(sqlite3_column_blob(a, i),
                                      sqlite3_column_blob(b, i), (size_t)n) == 0);
        }
    } while (*same && ra == SQLITE_ROW);
    if (ra != SQLITE_ROW && ra != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot check", e);
out:
    (void)sqlite3_finalize(a);
    (void)sqlite3_finalize(b);
    return st;
}

enum status store_sqlite_schema_check(struct store_sqlite_conn *c, store_report *report,
                                      void *arg, struct errinfo *e)
{
    sqlite3 *model = NULL;
    bool same = true;
    enum status st;

    if (sqlite3_open_v2(":memory:", &model, SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY,
                        NULL) != SQLITE_OK ||
        sqlite3_exec(model, schema_sql, NULL, NULL, NULL) != SQLITE_OK)
        st = errinfo_set(e, ST_EDB, "cannot make the schema to compare with: %s",
                         model != NULL ? sqlite3_errmsg(model) : "out of memory");
    else
        st = same_schema(c, model, &same, e);
    (void)sqlite3_close(model);
    if (st == ST_OK && !same)
        report(arg, "schema: the tables are not those of this program");
    return st;
}
