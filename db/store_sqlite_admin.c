#include <string.h>

#include "errinfo.h"
#include "store_sqlite.h"

enum status store_sqlite_admin_stats(struct store *s, struct store_stats *out,
                                     struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    uint64_t *const count[] = {&out->subjects,       &out->templates, &out->points,
                               &out->template_bytes, &out->events,    &out->tokens};
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_STATS, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_step(stmt) != SQLITE_ROW)
        st = store_sqlite_fail(c, "cannot count", e);
    else
        for (int i = 0; i < (int)(sizeof count / sizeof *count); i++)
            *count[i] = (uint64_t)sqlite3_column_int64(stmt, i);
    (void)sqlite3_reset(stmt);
    if (st == ST_OK)
        st = store_sqlite_size(c, &out->file_bytes, e);
    out->schema = STORE_SQLITE_SCHEMA;
out:
    store_sqlite_done(s, c);
    return st;
}

/* It does not go inside a transaction: out of the writer's, and into one that has nothing to
 * do.  SQLite writes into a database of its own, which it has to attach, and copies it back. */
enum status store_sqlite_admin_vacuum(struct store *s, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st = store_sqlite_write(s, true, &c, e);

    if (st != ST_OK)
        return st;
    (void)sqlite3_limit(c->db, SQLITE_LIMIT_ATTACHED, 1);
    if (sqlite3_exec(c->db, "COMMIT; VACUUM; BEGIN", NULL, NULL, NULL) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot write it anew", e);
    (void)sqlite3_limit(c->db, SQLITE_LIMIT_ATTACHED, 0);
    if ((st = store_sqlite_written(s, st, e)) == ST_OK)
        store_sqlite_erase_log(s);
    return st;
}

/* Every row of a pragma that names a problem a row, as "name: a, b, c". */
static enum status check_pragma(struct store_sqlite_conn *c, const char *sql,
                                const char *name, store_report *report, void *arg,
                                struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;
    int rc;

    if (sqlite3_prepare_v2(c->db, sql, -1, &stmt, NULL) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot check", e);
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        char line[400];
        size_t n;

        if (sqlite3_column_count(stmt) == 1 && sqlite3_column_bytes(stmt, 0) == 2 &&
            memcmp(sqlite3_column_text(stmt, 0), "ok", 2) == 0)
            continue;
        (void)sqlite3_snprintf(sizeof line, line, "%s:", name);
        for (int i = 0; i < sqlite3_column_count(stmt); i++) {
            const unsigned char *text = sqlite3_column_text(stmt, i);

            n = strlen(line);
            (void)sqlite3_snprintf((int)(sizeof line - n), line + n, "%s %.200s",
                                   i != 0 ? "," : "",
                                   text != NULL ? (const char *)text : "-");
        }
        for (char *p = line; *p != '\0'; p++)
            if ((unsigned char)*p < ' ')
                *p = ' '; /* one line a problem */
        report(arg, line);
    }
    if (rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot check", e);
    (void)sqlite3_finalize(stmt);
    return st;
}

enum status store_sqlite_admin_check(struct store *s, store_report *report, void *arg,
                                     struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = check_pragma(c, "PRAGMA integrity_check", "integrity", report, arg, e)) ==
            ST_OK &&
        (st = check_pragma(c, "PRAGMA foreign_key_check", "reference", report, arg, e)) ==
            ST_OK &&
        (st = store_sqlite_schema_check(c, report, arg, e)) == ST_OK &&
        (st = store_sqlite_token_check(c, report, arg, e)) == ST_OK)
        st = store_sqlite_calibration_check(c, report, arg, e);
    store_sqlite_done(s, c);
    return st;
}
