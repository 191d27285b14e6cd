/* Copies of the database: by SQLite's online backup, so that others may write meanwhile, and
 * read from the first to the last byte before they get their name. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "newfile.h"
#include "store_chain.h"
#include "store_sqlite.h"

/* ---- copying */

enum status store_sqlite_pages(struct store_sqlite_conn *from,
                               struct store_sqlite_conn *to, struct errinfo *e)
{
    sqlite3_backup *b = sqlite3_backup_init(to->db, "main", from->db, "main");
    int rc;

    if (b == NULL)
        return store_sqlite_fail(to, "cannot copy", e);
    rc = sqlite3_backup_step(b, -1); /* all of it: what is read is of one moment */
    if (sqlite3_backup_finish(b) == SQLITE_OK && rc == SQLITE_DONE)
        return ST_OK;
    if (sqlite3_errcode(to->db) != SQLITE_OK)
        return store_sqlite_fail(to, "cannot copy", e);
    return errinfo_set(e, rc == SQLITE_BUSY || rc == SQLITE_LOCKED ? ST_EBUSY : ST_EIO,
                       "cannot copy %.120s: %s", sqlite3_db_filename(from->db, "main"),
                       sqlite3_errstr(rc));
}

/* A log beside the part, which a process that was killed has left. */
static void remove_logs(const char *path)
{
    static const char *const suffix[] = {"-wal", "-shm", "-journal"};
    const size_t n = strlen(path) + sizeof "-journal";
    char *name = malloc(n);

    for (size_t i = 0; name != NULL && i < sizeof suffix / sizeof *suffix; i++) {
        (void)snprintf(name, n, "%s%s", path, suffix[i]);
        (void)unlink(name);
    }
    free(name);
}

static enum status run(struct store_sqlite_conn *c, const char *sql, struct errinfo *e)
{
    return sqlite3_exec(c->db, sql, NULL, NULL, NULL) == SQLITE_OK
               ? ST_OK
               : store_sqlite_fail(c, "cannot write", e);
}

enum status store_sqlite_copy(struct store_sqlite_conn *from, const struct newfile *n,
                              struct errinfo *e)
{
    struct store_sqlite_conn *to;
    enum status st;

    remove_logs(n->part);
    if ((st = store_sqlite_connect(n->part, SQLITE_OPEN_READWRITE, false, &to, e)) !=
        ST_OK)
        return st;
    /* It counts only when it has its name: until then nothing has to wait for the disk. */
    if ((st = run(to, "PRAGMA journal_mode=MEMORY; PRAGMA synchronous=OFF", e)) == ST_OK)
        st = store_sqlite_pages(from, to, e);
    store_sqlite_disconnect(to);
    if (st != ST_OK || (st = store_sqlite_connect(n->part, SQLITE_OPEN_READWRITE, false,
                                                  &to, e)) != ST_OK)
        return st;
    /* One file without a log beside it, which can be read where nothing can be written. */
    st = run(to, "PRAGMA journal_mode=DELETE", e);
    store_sqlite_disconnect(to);
    remove_logs(n->part);
    return st;
}

/* ---- verifying */

struct verifying {
    struct errinfo first; /* problem */
    struct store_copied *found;
};

static void problem(void *arg, const char *line)
{
    struct verifying *v = arg;

    if (v->first.code == ST_OK)
        (void)errinfo_set(&v->first, ST_ECORRUPT, "%s", line);
}

/* What the template's key proves is as it was written. */
static enum status count_template(void *arg, const struct store_template *t,
                                  const void *model, size_t len, struct errinfo *e)
{
    struct verifying *v = arg;

    (void)t;
    (void)model;
    (void)len;
    (void)e;
    v->found->templates++;
    return ST_OK;
}

static enum status verify_subjects(struct store *s, struct store_copied *found,
                                   struct errinfo *e)
{
    struct store_subject *page = NULL;
    int64_t after = 0;
    size_t n;
    enum status st;

    while ((st = store_sqlite_subject_list(s, after, 1000, &page, &n, e)) == ST_OK &&
           n > 0) {
        found->subjects += n;
        after = page[n - 1].key;
        free(page);
    }
    return st;
}

static void log_problem(void *arg, uint64_t seq, const char *line)
{
    char text[240];

    (void)sqlite3_snprintf(sizeof text, text, "audit log, entry %llu: %s",
                           (unsigned long long)seq, line);
    problem(arg, text);
}

static enum status verify_store(struct store *s, struct store_copied *found,
                                struct errinfo *e)
{
    struct verifying v = {.found = found};
    struct store_audit audit = {0};
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_admin_check(s, problem, &v, e)) != ST_OK ||
        (st = verify_subjects(s, found, e)) != ST_OK ||
        (st = store_sqlite_face_each(s, 0, 1, count_template, problem, &v, e)) != ST_OK ||
        (st = store_sqlite_audit_verify(s, log_problem, &v, &audit, e)) != ST_OK ||
        (st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    found->events = audit.entries;
    st = store_sqlite_size(c, &found->bytes, e);
    store_sqlite_done(s, c);
    if (st == ST_OK && v.first.code != ST_OK)
        st = errinfo_set(e, ST_ECORRUPT, "%s", v.first.msg);
    return st;
}

enum status store_sqlite_verify(const char *path, const struct store_key *key,
                                struct store_copied *found, struct errinfo *e)
{
    struct errinfo why = {ST_OK, ""};
    struct store *s;
    enum status st;

    memset(found, 0, sizeof *found);
    if ((st = store_sqlite_open(path, STORE_READ, key, &s, e)) != ST_OK)
        return st;
    st = verify_store(s, found, &why);
    s->engine->close(s);
    return st == ST_OK ? st : errinfo_set(e, st, "the copy is of no use: %s", why.msg);
}

/* ---- a backup */

/* What is there may be replaced if it is a database of this program, and not this one; nor
 * one with a log, which SQLite would take for the backup's. */
static enum status replaceable(const char *path, const char *db, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    struct stat there, own;
    int version;
    enum status st;

    if (stat(path, &there) != 0)
        return ST_OK;
    if (stat(db, &own) == 0 && there.st_dev == own.st_dev && there.st_ino == own.st_ino)
        return errinfo_set(e, ST_EINVAL, "%.160s is the database itself", path);
    if (store_sqlite_has_log(path))
        return errinfo_set(e, ST_EEXISTS,
                           "%.160s is a database in use, or was when its program was "
                           "killed: it has a %.160s-wal",
                           path, path);
    if (S_ISREG(there.st_mode) &&
        store_sqlite_connect(path, SQLITE_OPEN_READONLY, false, &c, NULL) == ST_OK) {
        st = store_sqlite_schema_version(c, path, &version, NULL);
        store_sqlite_disconnect(c);
        if (st == ST_OK)
            return ST_OK;
    }
    return errinfo_set(e, ST_EEXISTS,
                       "%.160s is there and no backup: it is not overwritten", path);
}

enum status store_sqlite_backup(struct store *s, const char *path,
                                const struct store_key *key, struct store_copied *out,
                                struct errinfo *e)
{
    struct newfile n = NEWFILE_NONE;
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = replaceable(path, sqlite3_db_filename(c->db, "main"), e)) == ST_OK &&
        (st = newfile_open(path, &n, e)) == ST_OK)
        st = store_sqlite_copy(c, &n, e);
    store_sqlite_done(s, c);
    if (st == ST_OK && (st = store_sqlite_verify(n.part, key, out, e)) == ST_OK)
        st = newfile_commit(&n, e);
    newfile_close(&n);
    return st;
}

/* ---- the backup that an upgrade begins with */

static enum status verify_old(const char *path, int version, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt = NULL;
    int found;
    enum status st;

    if ((st = store_sqlite_connect(path, SQLITE_OPEN_READONLY, false, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_schema_version(c, path, &found, e)) == ST_OK &&
        (found != version ||
         sqlite3_prepare_v2(c->db, "PRAGMA integrity_check", -1, &stmt, NULL) !=
             SQLITE_OK ||
         sqlite3_step(stmt) != SQLITE_ROW || sqlite3_column_bytes(stmt, 0) != 2 ||
         memcmp(sqlite3_column_text(stmt, 0), "ok", 2) != 0))
        st = errinfo_set(e, ST_ECORRUPT, "the database is damaged: it is not upgraded");
    (void)sqlite3_finalize(stmt);
    store_sqlite_disconnect(c);
    return st;
}

enum status store_sqlite_backup_old(const char *path, int version, struct newfile *n,
                                    struct errinfo *e)
{
    const size_t len = strlen(path) + 32;
    struct store_sqlite_conn *c;
    char *name = malloc(len);
    enum status st;

    if (name == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(name, len, "%s.v%d.bak", path, version);
    if ((st = newfile_open(name, n, e)) == ST_OK &&
        (st = store_sqlite_connect(path, SQLITE_OPEN_READWRITE, false, &c, e)) == ST_OK) {
        st = store_sqlite_copy(c, n, e);
        store_sqlite_disconnect(c);
    }
    if (st == ST_OK)
        st = verify_old(n->part, version, e);
    free(name);
    return st;
}

enum status store_sqlite_look(const char *path, struct store_look *out, struct errinfo *e)
{
    static const char sql[] = "SELECT (SELECT count(*) FROM subjects), "
                              "(SELECT count(*) FROM templates)";
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt = NULL;
    struct stat sb;
    enum status st;

    memset(out, 0, sizeof *out);
    out->newest = STORE_SQLITE_SCHEMA;
    if (stat(path, &sb) != 0)
        return errinfo_set(e, ST_ENOTFOUND, "there is no database %s", path);
    /* What a program that was killed has begun is taken back first, where it may be. */
    if ((st = store_sqlite_connect(path, SQLITE_OPEN_READWRITE, false, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_schema_version(c, path, &out->version, e)) != ST_OK ||
        (st = store_sqlite_size(c, &out->bytes, e)) != ST_OK || out->version == 0)
        goto out;
    if (sqlite3_prepare_v2(c->db, sql, -1, &stmt, NULL) == SQLITE_OK &&
        sqlite3_step(stmt) == SQLITE_ROW) {
        out->subjects = (uint64_t)sqlite3_column_int64(stmt, 0);
        out->templates = (uint64_t)sqlite3_column_int64(stmt, 1);
    } else {
        st = store_sqlite_fail(c, "cannot count", e);
    }
out:
    (void)sqlite3_finalize(stmt);
    store_sqlite_disconnect(c);
    return st;
}
