#include "sql_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "sql_sqlite.h"

/* ---- the files */

#define LOCK_AT 128
#define PATH    4096

/* What SQLite has beside a database; false: too long. */
static bool beside(const char *path, const char *suffix, char out[PATH])
{
    return snprintf(out, PATH, "%s%s", path, suffix) < PATH;
}

/* Every process that has the database open holds a lock on one byte of PATH-shm as long as it
 * does (SQLite's unix VFS, "dead man's switch"): asking for it changes nothing. */
bool sql_file_in_use(const char *path, int64_t *pid)
{
    struct flock lock = {
        .l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = LOCK_AT, .l_len = 1};
    char name[PATH];
    bool used = false;
    int fd;

    *pid = 0;
    if (beside(path, "-shm", name) && (fd = open(name, O_RDONLY | O_CLOEXEC)) >= 0) {
        used = fcntl(fd, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
        if (used && lock.l_pid > 0)
            *pid = lock.l_pid;
        (void)close(fd);
    }
    return used;
}

static bool has(const char *path, const char *suffix)
{
    char name[PATH];
    struct stat sb;

    return beside(path, suffix, name) && stat(name, &sb) == 0 && sb.st_size > 0;
}

bool sql_file_has_wal(const char *path)
{
    return has(path, "-wal") || has(path, "-journal");
}

enum status sql_file_may_be(const char *path, struct errinfo *e)
{
    if (!sql_file_has_wal(path))
        return ST_OK;
    return errinfo_set(
        e, ST_EEXISTS,
        "there is a %.160s%s of another database of that name: move it away "
        "first",
        path, has(path, "-wal") ? "-wal" : "-journal");
}

bool sql_file_same(const char *a, const char *b)
{
    struct stat sa, sb;

    return stat(a, &sa) == 0 && stat(b, &sb) == 0 && sa.st_dev == sb.st_dev &&
           sa.st_ino == sb.st_ino;
}

bool sql_file_is(const struct sql_txn *t)
{
    return t->driver->file;
}

/* NULL: it is behind a server, which takes care of itself. */
static struct sql_sqlite_conn *in_file(struct sql_txn *t)
{
    return sql_file_is(t) ? (struct sql_sqlite_conn *)t : NULL;
}

enum status sql_file_in_place(struct sql_txn *t, struct errinfo *e)
{
    const struct sql_sqlite_conn *c = in_file(t);
    struct stat sb;
    int moved = 0;

    if (c == NULL ||
        sqlite3_file_control(c->db, "main", SQLITE_FCNTL_HAS_MOVED, &moved) !=
            SQLITE_OK ||
        !moved)
        return ST_OK;
    /* SQLite says so too if the file system has failed for a moment. */
    if (stat(c->of->path, &sb) != 0 && errno != ENOENT && errno != ENOTDIR)
        return errinfo_set(e, ST_EIO, "cannot look at %.160s: %s", c->of->path,
                           strerror(errno));
    return errinfo_set(e, ST_EREFUSED,
                       "the database file was moved, removed or replaced");
}

/* ---- checking */

void sql_file_forget(struct sql_txn *t)
{
    struct sql_sqlite_conn *c = in_file(t);

    if (c == NULL)
        return;
    (void)atomic_fetch_add(&c->of->fresh, 1);
    sql_sqlite_conn_forget(c);
}

/* Every row of a pragma that names a problem a row, as "name: a, b, c". */
static enum status check_pragma(struct sql_sqlite_conn *t, const char *sql,
                                const char *name, sql_report *report, void *arg,
                                struct errinfo *e)
{
    sqlite3_stmt *stmt = NULL;
    enum status st = ST_OK;
    int rc = SQLITE_ROW;

    if (sqlite3_prepare_v2(t->db, sql, -1, &stmt, NULL) != SQLITE_OK)
        return sql_sqlite_conn_fail(t, "cannot check", e);
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
        st = sql_sqlite_conn_fail(t, "cannot check", e);
    (void)sqlite3_finalize(stmt);
    return st;
}

enum status sql_file_check(struct sql_txn *t, sql_report *report, void *arg,
                           struct errinfo *e)
{
    struct sql_sqlite_conn *c = in_file(t);
    struct errinfo why;
    enum status st;

    if (c == NULL)
        return ST_OK;
    st = check_pragma(c, "PRAGMA integrity_check", "integrity", report, arg, e);
    if (st != ST_OK)
        return st;
    st = check_pragma(c, "PRAGMA foreign_key_check", "reference", report, arg, &why);
    if (st == ST_EDB) { /* tables of another program, which cannot refer to each other */
        report(arg, why.msg);
        return ST_OK;
    }
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "%s", why.msg);
}

enum status sql_file_reindex(struct sql_txn *t, struct errinfo *e)
{
    struct sql_sqlite_conn *c = in_file(t);

    return c != NULL
               ? sql_sqlite_conn_exec(c, "REINDEX", "cannot build the indexes again", e)
               : ST_OK;
}

/* ---- copying */

static enum status copy_pages(struct sql_sqlite_conn *from, struct sql_sqlite_conn *to,
                              struct errinfo *e)
{
    sqlite3_backup *b = sqlite3_backup_init(to->db, "main", from->db, "main");
    int rc;

    if (b == NULL)
        return sql_sqlite_conn_fail(to, "cannot copy", e);
    rc = sqlite3_backup_step(b, -1); /* all of it: what is read is of one moment */
    if (sqlite3_backup_finish(b) == SQLITE_OK && rc == SQLITE_DONE)
        return ST_OK;
    if (sqlite3_errcode(to->db) != SQLITE_OK)
        return sql_sqlite_conn_fail(to, "cannot copy", e);
    return errinfo_set(e, rc == SQLITE_BUSY || rc == SQLITE_LOCKED ? ST_EBUSY : ST_EIO,
                       "cannot copy %.120s: %s", sqlite3_db_filename(from->db, "main"),
                       sqlite3_errstr(rc));
}

/* What a process that was killed has left beside a file of that name. */
static void remove_wal(const char *path)
{
    static const char *const suffix[] = {"-wal", "-shm", "-journal"};
    char name[PATH];

    for (size_t i = 0; i < sizeof suffix / sizeof *suffix; i++)
        if (beside(path, suffix[i], name))
            (void)unlink(name);
}

/* Run the driver's own statements on a connection of its own. */
static enum status with(const char *path, const char *sql, struct sql_sqlite_conn *from,
                        struct errinfo *e)
{
    struct sql_sqlite_conn *to;
    enum status st = sql_sqlite_conn_open(path, SQLITE_OPEN_READWRITE, false, &to, e);

    if (st != ST_OK)
        return st;
    if ((st = sql_sqlite_conn_exec(to, sql, "cannot write", e)) == ST_OK && from != NULL)
        st = copy_pages(from, to, e);
    sql_sqlite_conn_close(to);
    return st;
}

enum status sql_file_copy(struct sql_txn *t, const char *path, struct errinfo *e)
{
    enum status st;

    remove_wal(path);
    /* The copy counts only when it has its name: until then nothing has to wait for the
     * disk. */
    st = with(path, "PRAGMA journal_mode=MEMORY; PRAGMA synchronous=OFF", in_file(t), e);
    if (st != ST_OK)
        return st;
    /* One file, which can be read in a folder that cannot be written. */
    st = with(path, "PRAGMA journal_mode=DELETE", NULL, e);
    remove_wal(path);
    return st;
}

enum status sql_file_fold(struct sql *d, struct errinfo *e)
{
    return sql_sqlite_conn_exec(((struct sql_sqlite *)d)->writer,
                                "PRAGMA journal_mode=DELETE", "cannot write", e);
}

/* ---- free pages, deleted bytes */

/* SQLite writes into a database of its own, which it has to attach, and copies it back. */
enum status sql_file_compact(struct sql *of, struct errinfo *e)
{
    struct sql_sqlite *d = (struct sql_sqlite *)of;
    enum status st;

    if (!of->driver->file)
        return errinfo_set(
            e, ST_EINVAL,
            "the database is on a server: its autovacuum frees what deleted rows left");
    if ((st = sql_sqlite_lock(d, SQL_SQLITE_BUSY_MS, e)) != ST_OK)
        return st;
    (void)sqlite3_limit(d->writer->db, SQLITE_LIMIT_ATTACHED, 1);
    st = sql_sqlite_conn_exec(d->writer, "VACUUM", "cannot rewrite the file", e);
    (void)sqlite3_limit(d->writer->db, SQLITE_LIMIT_ATTACHED, 0);
    sql_sqlite_unlock(d);
    return st;
}

void sql_file_scrub(struct sql *of, int ms)
{
    struct sql_sqlite *d = (struct sql_sqlite *)of;

    if (!of->driver->file)
        return;
    atomic_store(&d->scrub, true); /* also if the writer's connection is not free */
    if (sql_sqlite_lock(d, SQL_SQLITE_BUSY_MS, NULL) != ST_OK)
        return;
    sql_sqlite_truncate(d, ms);
    sql_sqlite_unlock(d);
}

void sql_file_scrub_later(struct sql *of)
{
    if (of->driver->file)
        atomic_store(&((struct sql_sqlite *)of)->scrub, true);
}
