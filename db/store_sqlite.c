#include "store_sqlite.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "errinfo.h"

#define ERASE_MS    200
#define MAX_READERS 32

struct sqlite_store {
    struct store base;
    char *path;
    char *reading; /* what readers open: the path, or a URI */
    int flags;     /* with these */
    struct store_sqlite_vaults vaults;
    bool open;           /* store_open() has succeeded */
    atomic_bool keyless; /* the key was changed since, and is not known */

    pthread_mutex_t write_lock;       /* of `writing`, held but a moment */
    pthread_cond_t write_free;        /* by the monotonic clock */
    bool writing;                     /* somebody has the writer's connection */
    struct store_sqlite_conn *writer; /* NULL: opened for reading */
    int synced;        /* does the writer wait for the disk?  -1: not yet said */
    atomic_bool uncut; /* what was erased may be in the log still: somebody was reading */
    int64_t seen;      /* the last event that was looked at for erasures */

    pthread_mutex_t read_lock;
    pthread_cond_t read_free;
    struct store_sqlite_conn *idle;
    unsigned readers;
};

static struct sqlite_store *sqlite_store(struct store *s)
{
    return (struct sqlite_store *)(void *)s; /* base is its first member */
}

struct store_sqlite_vaults *store_sqlite_vaults(struct store *s)
{
    return &sqlite_store(s)->vaults;
}

/* ---- readers */

static enum status open_query(struct sqlite_store *q, struct store_sqlite_conn **c,
                              struct errinfo *e)
{
    enum status st = store_sqlite_connect(q->reading, q->flags, false, c, e);

    if (st == ST_OK &&
        sqlite3_exec((*c)->db, "PRAGMA query_only=ON", NULL, NULL, NULL) != SQLITE_OK) {
        st = store_sqlite_fail(*c, "cannot configure", e);
        store_sqlite_disconnect(*c);
        *c = NULL;
    }
    return st;
}

/* A connection at rest, or a new one. */
static enum status take(struct sqlite_store *q, struct store_sqlite_conn **c,
                        struct errinfo *e)
{
    enum status st = ST_OK;

    pthread_mutex_lock(&q->read_lock);
    while (q->idle == NULL && q->readers == MAX_READERS)
        pthread_cond_wait(&q->read_free, &q->read_lock);
    if ((*c = q->idle) != NULL)
        q->idle = (*c)->next;
    else
        q->readers++; /* its place is taken, it is opened outside the lock */
    pthread_mutex_unlock(&q->read_lock);
    if (*c == NULL && (st = open_query(q, c, e)) != ST_OK) {
        pthread_mutex_lock(&q->read_lock);
        q->readers--;
        pthread_cond_signal(&q->read_free);
        pthread_mutex_unlock(&q->read_lock);
    }
    return st;
}

static void give_back(struct sqlite_store *q, struct store_sqlite_conn *c)
{
    pthread_mutex_lock(&q->read_lock);
    c->next = q->idle;
    q->idle = c;
    pthread_cond_signal(&q->read_free);
    pthread_mutex_unlock(&q->read_lock);
}

/* A key that is lost or changed while the store is open is the database's trouble: whoever
 * asks lacks no permission and has not named what is missing. */
static enum status use_vault(struct sqlite_store *q, struct store_sqlite_conn *c,
                             struct errinfo *e)
{
    struct errinfo why;
    const enum status st = store_sqlite_vault_use(&q->vaults, c, &why);
    const bool keyless = st == ST_EDENIED || st == ST_ENOTFOUND || st == ST_EINVAL;

    atomic_store(&q->keyless, keyless);
    if (st == ST_OK)
        return ST_OK;
    if (!q->open || !keyless)
        return errinfo_set(e, st, "%s", why.msg);
    return errinfo_set(e, ST_EDB, "the database's key was changed: %.200s", why.msg);
}

enum status store_sqlite_read(struct store *s, struct store_sqlite_conn **c,
                              struct errinfo *e)
{
    struct sqlite_store *q = sqlite_store(s);
    enum status st;

    if ((st = take(q, c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_exec(*c, SQL_BEGIN_READ, e)) == ST_OK)
        st = use_vault(q, *c, e);
    if (st != ST_OK)
        store_sqlite_done(s, *c);
    return st;
}

void store_sqlite_done(struct store *s, struct store_sqlite_conn *c)
{
    if (!sqlite3_get_autocommit(c->db))
        (void)store_sqlite_exec(c, SQL_ROLLBACK, NULL); /* it has changed nothing */
    give_back(sqlite_store(s), c);
}

/* ---- transactions */

/* A pragma takes effect when it is compiled: a prepared statement would not do. */
static enum status set_synced(struct sqlite_store *q, bool synced, struct errinfo *e)
{
    if (q->synced == (synced ? 1 : 0))
        return ST_OK;
    if (sqlite3_exec(q->writer->db,
                     synced ? "PRAGMA synchronous=FULL" : "PRAGMA synchronous=NORMAL",
                     NULL, NULL, NULL) != SQLITE_OK)
        return store_sqlite_fail(q->writer, "cannot configure", e);
    q->synced = synced ? 1 : 0;
    return ST_OK;
}

/* The writer's transaction, by the key that holds now. */
static enum status begin_keyed(struct sqlite_store *q, struct errinfo *e)
{
    enum status st = store_sqlite_exec(q->writer, SQL_BEGIN, e);

    if (st == ST_OK && (st = use_vault(q, q->writer, e)) != ST_OK)
        (void)store_sqlite_exec(q->writer, SQL_ROLLBACK, NULL);
    return st;
}

/* Wait up to ms for the writer's connection.  What is left of that SQLite may then wait for
 * other processes: else threads would wait for one another's waiting. */
static enum status lock_writer(struct sqlite_store *q, long ms, struct errinfo *e)
{
    struct timespec until, now;
    long left;
    int rc = 0;

    if (q->writer == NULL)
        return errinfo_set(e, ST_EDENIED, "%s: opened for reading only", q->path);
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += ms / 1000;
    until.tv_nsec += ms % 1000 * 1000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    pthread_mutex_lock(&q->write_lock);
    while (q->writing && rc == 0)
        rc = pthread_cond_timedwait(&q->write_free, &q->write_lock, &until);
    if (!q->writing)
        rc = 0;
    q->writing = true;
    pthread_mutex_unlock(&q->write_lock);
    if (rc != 0)
        return errinfo_set(e, ST_EBUSY, "%s: other threads are writing", q->path);
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    left = (long)(until.tv_sec - now.tv_sec) * 1000 +
           (until.tv_nsec - now.tv_nsec) / 1000000;
    (void)sqlite3_busy_timeout(q->writer->db, left > 0 ? (int)left : 0);
    return ST_OK;
}

static void unlock_writer(struct sqlite_store *q)
{
    pthread_mutex_lock(&q->write_lock);
    q->writing = false;
    pthread_cond_signal(&q->write_free);
    pthread_mutex_unlock(&q->write_lock);
}

static enum status begin(struct sqlite_store *q, long ms, bool synced,
                         struct store_sqlite_conn **c, struct errinfo *e)
{
    enum status st = lock_writer(q, ms, e);

    if (st != ST_OK)
        return st;
    *c = q->writer;
    if ((st = set_synced(q, synced, e)) == ST_OK)
        st = begin_keyed(q, e);
    if (st != ST_OK)
        unlock_writer(q);
    return st;
}

enum status store_sqlite_write(struct store *s, bool synced, struct store_sqlite_conn **c,
                               struct errinfo *e)
{
    return begin(sqlite_store(s), STORE_SQLITE_BUSY_MS, synced, c, e);
}

enum status store_sqlite_try(struct store *s, struct store_sqlite_conn **c,
                             struct errinfo *e)
{
    return begin(sqlite_store(s), 0, false, c, e);
}

/* ---- the log */

/* SQLite does not wait for its own cut: after a loss of power the log would be whole again. */
static bool sync_log(sqlite3 *db)
{
    sqlite3_file *log = NULL;

    return sqlite3_file_control(db, "main", SQLITE_FCNTL_JOURNAL_POINTER, &log) ==
               SQLITE_OK &&
           log != NULL && log->pMethods != NULL &&
           log->pMethods->xSync(log, SQLITE_SYNC_NORMAL) == SQLITE_OK;
}

/* Others may be reading: for ms they are waited for.  The writer's connection is locked. */
static void cut_log(struct sqlite_store *q, int ms)
{
    (void)sqlite3_busy_timeout(q->writer->db, ms);
    if (sqlite3_wal_checkpoint_v2(q->writer->db, NULL, SQLITE_CHECKPOINT_TRUNCATE, NULL,
                                  NULL) == SQLITE_OK &&
        sync_log(q->writer->db))
        atomic_store(&q->uncut, false);
}

static void truncate_log(struct sqlite_store *q, int ms)
{
    atomic_store(&q->uncut, true); /* also where the writer cannot be had */
    if (lock_writer(q, STORE_SQLITE_BUSY_MS, NULL) != ST_OK)
        return;
    cut_log(q, ms);
    unlock_writer(q);
}

/* Whether anybody has erased since this was asked last: another process, too, may have ended
 * before it could cut the log.  The writer's connection is locked. */
static bool erased_since(struct sqlite_store *q)
{
    sqlite3_stmt *stmt;
    bool erased = false;

    if (store_sqlite_prepare(q->writer, SQL_EVENT_ERASED, &stmt, NULL) != ST_OK)
        return false;
    if (sqlite3_bind_int64(stmt, 1, q->seen) == SQLITE_OK &&
        sqlite3_step(stmt) == SQLITE_ROW) {
        q->seen = sqlite3_column_int64(stmt, 0);
        erased = sqlite3_column_int(stmt, 1) != 0;
    }
    (void)sqlite3_reset(stmt);
    return erased;
}

enum status store_sqlite_written(struct store *s, enum status st, struct errinfo *e)
{
    struct sqlite_store *q = sqlite_store(s);

    if (st == ST_OK)
        st = store_sqlite_exec(q->writer, SQL_COMMIT, e);
    if (st != ST_OK && !sqlite3_get_autocommit(q->writer->db))
        (void)store_sqlite_exec(q->writer, SQL_ROLLBACK, NULL);
    if (atomic_load(&q->uncut)) /* costs little while the reader is there */
        cut_log(q, 0);
    /* Our own is cut by store_sqlite_erase_log(), another process's at the next change. */
    if (erased_since(q))
        atomic_store(&q->uncut, true);
    unlock_writer(q);
    return st;
}

void store_sqlite_erase_log(struct store *s)
{
    truncate_log(sqlite_store(s), ERASE_MS);
}

enum status store_sqlite_rewrite(struct store *s, struct errinfo *e)
{
    struct sqlite_store *q = sqlite_store(s);
    enum status st = lock_writer(q, STORE_SQLITE_BUSY_MS, e);

    if (st != ST_OK)
        return st;
    (void)sqlite3_limit(q->writer->db, SQLITE_LIMIT_ATTACHED, 1); /* its own copy */
    if (sqlite3_exec(q->writer->db, "VACUUM", NULL, NULL, NULL) != SQLITE_OK)
        st = store_sqlite_fail(q->writer, "cannot write the file anew", e);
    (void)sqlite3_limit(q->writer->db, SQLITE_LIMIT_ATTACHED, 0);
    unlock_writer(q);
    return st;
}

/* ---- opening */

/* Look at the file before SQLite does, for errors that say what is wrong, and make a new
 * one ourselves: SQLite would let others read it. */
static enum status check_file(const char *path, enum store_mode mode, bool *made,
                              struct errinfo *e)
{
    struct stat sb;
    int fd;

    *made = false;
    if (path[0] == '\0' || path[0] == ':')
        return errinfo_set(e, ST_EINVAL, "'%s' is no path for a database", path);
    if (stat(path, &sb) != 0) {
        if (errno != ENOENT)
            return errinfo_set(e, ST_EIO, "cannot open %s: %s", path, strerror(errno));
        if (mode != STORE_CREATE)
            return errinfo_set(e, ST_ENOTFOUND, "there is no database %s", path);
        if ((fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600)) < 0 &&
            errno != EEXIST)
            return errinfo_set(e, ST_EIO, "cannot create %s: %s", path, strerror(errno));
        if (fd >= 0) {
            *made = true;
            (void)close(fd);
        }
        return ST_OK;
    }
    if (!S_ISREG(sb.st_mode))
        return errinfo_set(e, ST_EINVAL, "%s is not a file", path);
    if (faccessat(AT_FDCWD, path, mode == STORE_READ ? R_OK : R_OK | W_OK, AT_EACCESS) !=
        0)
        return errinfo_set(e, ST_EIO, "cannot %s %s: %s",
                           mode == STORE_READ ? "read" : "write", path, strerror(errno));
    return ST_OK;
}

static enum status too_old(const struct sqlite_store *q, int version, struct errinfo *e)
{
    return errinfo_set(e, ST_EVERSION,
                       "%s has schema version %d, this program needs %d: "
                       "surfacectl migrate upgrades it",
                       q->path, version, STORE_SQLITE_SCHEMA);
}

static enum status open_writer(struct sqlite_store *q, enum store_mode mode,
                               struct errinfo *e)
{
    int version;
    enum status st;

    if ((st = store_sqlite_connect(q->path, SQLITE_OPEN_READWRITE, false, &q->writer,
                                   e)) != ST_OK)
        return st;
    if ((st = store_sqlite_schema_version(q->writer, q->path, &version, e)) != ST_OK)
        return st;
    if (version == 0 && mode != STORE_CREATE)
        return errinfo_set(e, ST_ENOTFOUND, "%s is empty: it has to be initialised",
                           q->path);
    if (version > 0 && version < STORE_SQLITE_SCHEMA && mode != STORE_MIGRATE)
        return too_old(q, version, e);
    if (version < STORE_SQLITE_SCHEMA &&
        (st = store_sqlite_schema_make(q->writer, &q->vaults, q->path, e)) != ST_OK)
        return st;
    /* Deleted bytes are overwritten. */
    if (sqlite3_exec(q->writer->db,
                     "PRAGMA journal_mode=WAL;"
                     "PRAGMA secure_delete=ON; PRAGMA journal_size_limit=16777216",
                     NULL, NULL, NULL) != SQLITE_OK)
        return store_sqlite_fail(q->writer, "cannot configure", e);
    /* Fail now rather than at the first change. */
    if ((st = begin_keyed(q, e)) == ST_OK)
        st = store_sqlite_exec(q->writer, SQL_ROLLBACK, e);
    return st;
}

static enum status open_reader(struct sqlite_store *q, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    int version;
    enum status st;

    if ((st = take(q, &c, e)) != ST_OK)
        return st;
    st = store_sqlite_schema_version(c, q->path, &version, e);
    give_back(q, c);
    if (st == ST_OK && version == 0)
        st = errinfo_set(e, ST_ENOTFOUND, "%s is empty: it has to be initialised",
                         q->path);
    else if (st == ST_OK && version < STORE_SQLITE_SCHEMA)
        st = too_old(q, version, e);
    /* Is the key the right one? */
    if (st == ST_OK && (st = store_sqlite_read(&q->base, &c, e)) == ST_OK)
        store_sqlite_done(&q->base, c);
    return st;
}

void store_sqlite_close(struct store *s)
{
    struct sqlite_store *q = sqlite_store(s);
    struct store_sqlite_conn *c;

    while ((c = q->idle) != NULL) {
        q->idle = c->next;
        store_sqlite_disconnect(c);
    }
    /* Last: with it SQLite brings in the log and removes it. */
    store_sqlite_disconnect(q->writer);
    (void)pthread_cond_destroy(&q->read_free);
    (void)pthread_mutex_destroy(&q->read_lock);
    (void)pthread_cond_destroy(&q->write_free);
    (void)pthread_mutex_destroy(&q->write_lock);
    store_sqlite_vault_free(&q->vaults);
    free(q->reading);
    free(q->path);
    free(q);
}

/* How readers open the database.  The last to close it brings in its log and removes it,
 * and has to be able to write for that; query_only keeps it from changing anything else.
 * Who may not write the file must not make a log for it either, which those who may could
 * then not write: where there is none, the file is read as one that nobody changes. */
static bool choose_reading(struct sqlite_store *q, enum store_mode mode)
{
    static const char hex[] = "0123456789ABCDEF";
    const size_t n = strlen(q->path);
    bool frozen;
    char *to;

    if ((q->reading = malloc(3 * n + sizeof "file:?immutable=1-wal")) == NULL)
        return false;
    to = q->reading;
    (void)snprintf(to, n + sizeof "-wal", "%s-wal", q->path);
    frozen = mode == STORE_READ && access(to, F_OK) != 0;
    (void)snprintf(to, n + 1, "%s", q->path);
    q->flags = SQLITE_OPEN_READONLY;
    if (mode == STORE_READ && faccessat(AT_FDCWD, q->path, W_OK, AT_EACCESS) == 0)
        q->flags = SQLITE_OPEN_READWRITE;
    else if (frozen) {
        q->flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
        memcpy(to, "file:", 5);
        to += 5;
        for (const char *p = q->path; *p != '\0'; p++) {
            if (p == q->path)
                p += strspn(p, "/") > 1 ? strspn(p, "/") - 1
                                        : 0; /* "//" would be a host */
            if (*p == '%' || *p == '?' || *p == '#') {
                *to++ = '%';
                *to++ = hex[(unsigned char)*p >> 4];
                *to++ = hex[*p & 15];
            } else {
                *to++ = *p;
            }
        }
        memcpy(to, "?immutable=1", sizeof "?immutable=1");
    }
    return true;
}

enum status store_sqlite_open(const char *path, enum store_mode mode,
                              const struct store_key *key, struct store **out,
                              struct errinfo *e)
{
    struct sqlite_store *q;
    pthread_condattr_t monotonic;
    bool made;
    enum status st;

    *out = NULL;
    if ((st = check_file(path, mode, &made, e)) != ST_OK)
        return st;
    if ((q = calloc(1, sizeof *q)) == NULL || (q->path = strdup(path)) == NULL ||
        !choose_reading(q, mode)) {
        if (q != NULL)
            free(q->path);
        free(q);
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
        goto out;
    }
    q->base.engine = &store_sqlite_engine;
    q->synced = -1;
    q->seen = INT64_MAX; /* none: what was erased before is cut below */
    (void)pthread_mutex_init(&q->write_lock, NULL);
    (void)pthread_condattr_init(&monotonic);
    (void)pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&q->write_free, &monotonic);
    (void)pthread_condattr_destroy(&monotonic);
    (void)pthread_mutex_init(&q->read_lock, NULL);
    (void)pthread_cond_init(&q->read_free, NULL);
    st = store_sqlite_vault_init(&q->vaults, path, key, e);
    if (st == ST_OK && mode != STORE_READ)
        st = open_writer(q, mode, e);
    if (st == ST_OK)
        st = open_reader(q, e);
    if (st == ST_OK && mode != STORE_READ)
        (void)erased_since(q);
    /* Who was killed between an erasure and its end has left the bytes in the log. */
    if (st == ST_OK && mode != STORE_READ && !made)
        truncate_log(q, 0);
    if (st == ST_OK) {
        q->open = true;
        *out = &q->base;
    } else {
        store_sqlite_close(&q->base);
    }
out:
    if (st != ST_OK && made)
        (void)unlink(path); /* nothing was ever in it */
    return st;
}

enum status store_sqlite_kind(const char *path, enum vault_kind *kind, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    int version;
    bool made;
    enum status st;

    *kind = VAULT_OPEN;
    if ((st = check_file(path, STORE_READ, &made, e)) != ST_OK ||
        (st = store_sqlite_connect(path, SQLITE_OPEN_READWRITE, false, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_schema_version(c, path, &version, e)) == ST_OK) {
        if (version == STORE_SQLITE_SCHEMA)
            st = store_sqlite_vault_kind(c, kind, e);
        else
            st = errinfo_set(e, ST_EVERSION, "%s has schema version %d", path, version);
    }
    store_sqlite_disconnect(c);
    return st;
}

enum status store_sqlite_ready(struct store *s, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    struct errinfo why;
    int moved = 0;
    enum status st;

    if ((st = store_sqlite_read(s, &c, &why)) != ST_OK)
        return errinfo_set(e, atomic_load(&sqlite_store(s)->keyless) ? ST_EDENIED : st,
                           "%s", why.msg);
    if ((st = store_sqlite_prepare(c, SQL_VERSION, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_step(stmt) != SQLITE_ROW)
        st = store_sqlite_fail(c, "cannot read", e);
    else if (sqlite3_column_int(stmt, 0) != STORE_SQLITE_SCHEMA)
        st = errinfo_set(e, ST_EVERSION, "the database has schema version %d, not %d",
                         sqlite3_column_int(stmt, 0), STORE_SQLITE_SCHEMA);
    (void)sqlite3_reset(stmt);
    if (st == ST_OK &&
        sqlite3_file_control(c->db, "main", SQLITE_FCNTL_HAS_MOVED, &moved) ==
            SQLITE_OK &&
        moved)
        st = errinfo_set(e, ST_EIO, "the database file was moved or removed");
out:
    store_sqlite_done(s, c);
    return st;
}
