#include "sql_sqlite.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "errinfo.h"
#include "schema_sql.h"

/* ---- the reading connections: as many as threads read at a time */

static enum status open_query(struct sql_sqlite *d, struct sql_sqlite_conn **c,
                              struct errinfo *e)
{
    enum status st = sql_sqlite_conn_open(d->path, d->flags, false, c, e);

    if (st != ST_OK)
        return st;
    (*c)->of = d;
    st = sql_sqlite_conn_exec(*c, "PRAGMA query_only=ON", "cannot configure", e);
    if (st != ST_OK)
        sql_sqlite_conn_close(*c);
    return st;
}

static enum status sql_sqlite_take(struct sql_sqlite *d, struct sql_sqlite_conn **c,
                                   struct errinfo *e)
{
    pthread_mutex_lock(&d->lock);
    if ((*c = d->idle) != NULL)
        d->idle = (*c)->next;
    pthread_mutex_unlock(&d->lock);
    return *c != NULL ? ST_OK : open_query(d, c, e);
}

static void give_back(struct sql_sqlite *d, struct sql_sqlite_conn *c)
{
    pthread_mutex_lock(&d->lock);
    c->next = d->idle;
    d->idle = c;
    pthread_mutex_unlock(&d->lock);
}

/* ---- the writing connection */

/* Threads wait for one another here, and not in SQLite, so that their waiting does not add
 * up. */
enum status sql_sqlite_lock(struct sql_sqlite *d, long ms, struct errinfo *e)
{
    struct timespec until, now;
    long left;
    int rc = 0;

    if (d->writer == NULL)
        return errinfo_set(e, ST_EDENIED, "%s: opened for reading only", d->path);
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += ms / 1000;
    until.tv_nsec += ms % 1000 * 1000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_mutex_lock(&d->lock);
    while (d->writing && rc == 0)
        rc = pthread_cond_timedwait(&d->write_free, &d->lock, &until);
    if (!d->writing)
        rc = 0;
    d->writing = true;
    pthread_mutex_unlock(&d->lock);
    if (rc != 0)
        return errinfo_set(e, ST_EBUSY, "%s: other threads are writing", d->path);
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    left = (long)(until.tv_sec - now.tv_sec) * 1000 +
           (until.tv_nsec - now.tv_nsec) / 1000000;
    (void)sqlite3_busy_timeout(d->writer->db, left > 0 ? (int)left : 0);
    return ST_OK;
}

void sql_sqlite_unlock(struct sql_sqlite *d)
{
    pthread_mutex_lock(&d->lock);
    d->writing = false;
    pthread_cond_signal(&d->write_free);
    pthread_mutex_unlock(&d->lock);
}

/* SQLite does not fsync after truncating the WAL: after a power failure it would be whole
 * again. */
static bool sync_wal(sqlite3 *db)
{
    sqlite3_file *wal = NULL;

    return sqlite3_file_control(db, "main", SQLITE_FCNTL_JOURNAL_POINTER, &wal) ==
               SQLITE_OK &&
           wal != NULL && wal->pMethods != NULL &&
           wal->pMethods->xSync(wal, SQLITE_SYNC_NORMAL) == SQLITE_OK;
}

void sql_sqlite_truncate(struct sql_sqlite *d, int ms)
{
    (void)sqlite3_busy_timeout(d->writer->db, ms);
    if (sqlite3_wal_checkpoint_v2(d->writer->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL,
                                  NULL) == SQLITE_OK &&
        sync_wal(d->writer->db))
        atomic_store(&d->scrub, false);
}

/* ---- transactions */

/* BEGIN and its like are the driver's own, and the commonest of all. */
static enum status sql_sqlite_step(struct sql_sqlite_conn *c, const char *text,
                                   struct errinfo *e)
{
    return sql_run(&c->base, text, NULL, 0, e);
}

/* Deleted bytes are overwritten. */
#define USE_WAL                                                                          \
    "PRAGMA journal_mode=WAL; PRAGMA secure_delete=ON; PRAGMA journal_size_limit=16777216"

/* Large pages, in a new file: a template of 79 KB is five of them one after the other, not
 * twenty, which a disk notices (docs/database.md). */
static const struct {
    const char *configure, *begin;
} transaction[] = {
    [SQL_READ] = {"", "BEGIN"},
    [SQL_WRITE] = {"PRAGMA synchronous=FULL", "BEGIN IMMEDIATE"},
    [SQL_LAZY] = {"PRAGMA synchronous=NORMAL", "BEGIN IMMEDIATE"},
    [SQL_TRY] = {"PRAGMA synchronous=NORMAL", "BEGIN IMMEDIATE"},
    [SQL_SCHEMA] = {"PRAGMA page_size=16384; " USE_WAL "; PRAGMA synchronous=FULL",
                    "BEGIN EXCLUSIVE"},
    [SQL_COPY] = {"PRAGMA page_size=16384; PRAGMA journal_mode=MEMORY; "
                  "PRAGMA secure_delete=ON; PRAGMA synchronous=OFF",
                  "BEGIN EXCLUSIVE"},
};

static void sql_sqlite_release(struct sql_sqlite_conn *t)
{
    if (t != t->of->writer)
        give_back(t->of, t);
    else
        sql_sqlite_unlock(t->of);
}

static enum status sql_sqlite_begin(struct sql *of, enum sql_begin how,
                                    struct sql_txn **t, struct errinfo *e)
{
    struct sql_sqlite *d = (struct sql_sqlite *)of;
    struct sql_sqlite_conn *c = d->writer;
    enum status st;

    if (how == SQL_READ && !d->single)
        st = sql_sqlite_take(d, &c, e);
    else
        st = sql_sqlite_lock(d, how == SQL_TRY ? 0 : SQL_SQLITE_BUSY_MS, e);
    if (st != ST_OK)
        return st;
    sql_sqlite_conn_forget(c);
    c->writes = how != SQL_READ;
    c->makes = how == SQL_SCHEMA || how == SQL_COPY;
    st = sql_sqlite_conn_exec(c, transaction[how].configure, "cannot configure", e);
    if (st != ST_OK || (st = sql_sqlite_step(c, transaction[how].begin, e)) != ST_OK)
        sql_sqlite_release(c);
    *t = &c->base;
    return st;
}

static enum status sql_sqlite_end(struct sql_txn *t, enum status st, struct errinfo *e)
{
    struct sql_sqlite_conn *c = (struct sql_sqlite_conn *)t;
    struct sql_sqlite *d = c->of;

    if (st == ST_OK && c->writes)
        st = sql_sqlite_step(c, "COMMIT", e);
    if (!sqlite3_get_autocommit(c->db))
        (void)sql_sqlite_step(c, "ROLLBACK",
                              NULL); /* a reader's, which has changed nothing, too */
    if (st == ST_OK && c->makes)
        d->made = false;
    if (c->writes && atomic_load(&d->scrub)) /* costs little while the reader is there */
        sql_sqlite_truncate(d, 0);
    sql_sqlite_release(c);
    return st;
}

static enum status version(struct sql_txn *t, int *out, struct errinfo *e)
{
    return sql_sqlite_conn_version((struct sql_sqlite_conn *)t, out, e);
}

static enum status sql_sqlite_create(struct sql_txn *t, struct errinfo *e)
{
    struct sql_sqlite_conn *c = (struct sql_sqlite_conn *)t;
    const enum status st =
        sql_sqlite_conn_exec(c, schema_sql, "cannot create the tables", e);

    if (st == ST_OK)
        c->of->base.version = SQL_SQLITE_VERSION;
    return st;
}

static enum status bytes(struct sql_txn *t, uint64_t *out, struct errinfo *e)
{
    struct sql_sqlite_conn *c = (struct sql_sqlite_conn *)t;
    int64_t pages = 0, size = 0;
    enum status st;

    if ((st = sql_sqlite_conn_int(c, "PRAGMA page_count", &pages, e)) == ST_OK &&
        (st = sql_sqlite_conn_int(c, "PRAGMA page_size", &size, e)) == ST_OK)
        *out = (uint64_t)pages * (uint64_t)size;
    return st;
}

/* ---- opening */

/* Look at the file before SQLite does, for errors that say what is wrong, and make a new
 * one ourselves: SQLite would let others read it. */
static enum status check_file(struct sql_sqlite *d, enum sql_open how, struct errinfo *e)
{
    const bool read = how == SQL_OPEN_READ;
    const char *path = d->path;
    struct stat sb;
    int fd;

    if (path[0] == '\0' || path[0] == ':')
        return errinfo_set(e, ST_EINVAL, "'%s' is not a path for a database", path);
    if (stat(path, &sb) != 0) {
        if (errno != ENOENT)
            return errinfo_set(e, ST_EIO, "cannot open %s: %s", path, strerror(errno));
        if (how != SQL_OPEN_CREATE)
            return errinfo_set(e, ST_ENOTFOUND, "there is no database %s", path);
        if ((fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600)) < 0 &&
            errno != EEXIST)
            return errinfo_set(e, ST_EIO, "cannot create %s: %s", path, strerror(errno));
        if (fd >= 0) {
            d->made = true;
            (void)close(fd);
        }
        return ST_OK;
    }
    if (!S_ISREG(sb.st_mode))
        return errinfo_set(e, ST_EINVAL, "%s is not a file", path);
    if (faccessat(AT_FDCWD, path, read ? R_OK : R_OK | W_OK, AT_EACCESS) != 0)
        return errinfo_set(e, ST_EIO, "cannot %s %s: %s", read ? "read" : "write", path,
                           strerror(errno));
    return ST_OK;
}

static enum status new_database(const char *path, enum sql_open how,
                                struct sql_sqlite **out, struct errinfo *e)
{
    struct sql_sqlite *d = calloc(1, sizeof *d);
    pthread_condattr_t monotonic;

    *out = d;
    if (d == NULL)
        return errinfo_memory(e);
    d->base.driver = &sql_sqlite_driver;
    d->flags = SQLITE_OPEN_READONLY;
    d->single = how == SQL_OPEN_ALONE;
    (void)pthread_mutex_init(&d->lock, NULL);
    (void)pthread_condattr_init(&monotonic);
    (void)pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&d->write_free, &monotonic);
    (void)pthread_condattr_destroy(&monotonic);
    return (d->path = strdup(path)) != NULL ? ST_OK : errinfo_memory(e);
}

/* SQLite first rolls back a transaction of a killed program, if it can write. */
static enum status open_writer(struct sql_sqlite *d, enum sql_open how, struct errinfo *e)
{
    enum status st = sql_sqlite_conn_open(d->path, SQLITE_OPEN_READWRITE,
                                          how == SQL_OPEN_ALONE, &d->writer, e);

    if (st != ST_OK)
        return st;
    d->writer->of = d;
    st = sql_sqlite_conn_version(d->writer, &d->base.version, e);
    return st == ST_OK && d->base.version > 0 && !d->single
               ? sql_sqlite_conn_exec(d->writer, USE_WAL, "cannot configure", e)
               : st;
}

/* The last to close the database brings in its WAL and removes it, and has to be able to write for
 * that; query_only keeps it from changing anything else. */
static enum status open_reader(struct sql_sqlite *d, struct errinfo *e)
{
    struct sql_sqlite_conn *c;
    enum status st;

    if (faccessat(AT_FDCWD, d->path, W_OK, AT_EACCESS) == 0)
        d->flags = SQLITE_OPEN_READWRITE;
    st = sql_sqlite_take(d, &c, e);
    if (st != ST_OK)
        return st;
    st = sql_sqlite_conn_version(c, &d->base.version, e);
    give_back(d, c);
    return st;
}

/* The file is new: it goes, unless another process has it open or has made a database in it.  Without
 * a WAL, which SQLite would leave beside a file that is not there any more. */
static void remove_made(struct sql_sqlite *d)
{
    int version = 1;

    if (sql_sqlite_conn_exec(d->writer,
                             "PRAGMA locking_mode=EXCLUSIVE; PRAGMA journal_mode=DELETE; "
                             "BEGIN EXCLUSIVE",
                             "cannot lock", NULL) != ST_OK)
        return;
    if (sql_sqlite_conn_version(d->writer, &version, NULL) == ST_OK && version == 0)
        (void)unlink(d->path);
    (void)sql_sqlite_conn_exec(d->writer, "ROLLBACK", "cannot end", NULL);
}

static void close_all(struct sql *of)
{
    struct sql_sqlite *d = (struct sql_sqlite *)of;
    struct sql_sqlite_conn *c;

    while ((c = d->idle) != NULL) {
        d->idle = c->next;
        sql_sqlite_conn_close(c);
    }
    if (d->made && d->writer != NULL)
        remove_made(d);
    /* Last: with it SQLite brings in the WAL and removes it. */
    sql_sqlite_conn_close(d->writer);
    (void)pthread_cond_destroy(&d->write_free);
    (void)pthread_mutex_destroy(&d->lock);
    free(d->path);
    free(d);
}

enum status sql_sqlite_open(const char *path, enum sql_open how, struct sql **out,
                            struct errinfo *e)
{
    struct sql_sqlite *d;
    enum status st = new_database(path, how, &d, e);

    if (st == ST_OK && (st = check_file(d, how, e)) == ST_OK)
        st = how == SQL_OPEN_READ ? open_reader(d, e) : open_writer(d, how, e);
    if (st == ST_OK)
        *out = &d->base;
    else if (d != NULL)
        close_all(&d->base);
    return st;
}

const struct sql_driver sql_sqlite_driver = {
    .file = true,
    .close = close_all,
    .begin = sql_sqlite_begin,
    .end = sql_sqlite_end,
    .version = version,
    .create = sql_sqlite_create,
    .bytes = bytes,
    .run = sql_sqlite_conn_run,
    .changed = sql_sqlite_conn_changed,
    .query = sql_sqlite_conn_query,
    .next = sql_sqlite_conn_next,
    .column = sql_sqlite_conn_column,
    .done = sql_sqlite_conn_done,
};
