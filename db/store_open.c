#include "store_open.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "crypt_file.h"
#include "log_anchor.h"
#include "newfile.h"
#include "rows_root.h"
#include "sql_file.h"
#include "sql_open.h"
#include "store_txn.h"

/* ---- keys */

struct opening {
    const char *path;
    const struct store_key *key;
    char *key_path;
    bool made; /* the key's file */
};

static enum status open_by_file(const char *path, const struct crypt_root *r,
                                struct crypt **out, struct errinfo *e)
{
    struct crypt_file *k;
    enum status st = crypt_file_read(path, &k, e);

    if (st != ST_OK)
        return st;
    st = crypt_file_open(k, path, r, out, e);
    crypt_file_free(k);
    return st;
}

/* A rekey that was killed may have left the key as KEY.new. */
static enum status open_by_files(const char *path, const struct crypt_root *r,
                                 struct crypt **out, struct errinfo *e)
{
    enum status st = open_by_file(path, r, out, e);
    char *next;

    if (st != ST_EDENIED && st != ST_ENOTFOUND && st != ST_EINVAL)
        return st;
    if (newfile_beside(path, STORE_KEY_NEW, &next, NULL) != ST_OK)
        return st;
    if (open_by_file(next, r, out, NULL) == ST_OK)
        st = ST_OK;
    free(next);
    return st;
}

/* A plaintext root carries its own master key, so that a process which can write the file can make
 * one.  If the operator says that the database is plaintext, it is accepted, and only it. */
static enum status open_root(const struct opening *o, const struct crypt_root *r,
                             struct crypt **out, struct errinfo *e)
{
    if (r->kind == CRYPT_PLAINTEXT && !o->key->plaintext)
        return errinfo_set(
            e, ST_EDENIED,
            "%.100s is plaintext: restore a backup; or, if it is meant to be "
            "plaintext, say so with --plaintext-database",
            o->path);
    if (r->kind != CRYPT_PLAINTEXT && o->key->plaintext)
        return errinfo_set(e, ST_EDENIED,
                           "%.100s is encrypted: it takes no --plaintext-database",
                           o->path);
    if (r->kind == CRYPT_PLAINTEXT)
        return crypt_open(r, NULL, 0, out, e);
    if (o->key->given != NULL)
        return crypt_file_open(o->key->given, "the key", r, out, e);
    return open_by_files(o->key_path, r, out, e);
}

static enum status make_by_phrase(const struct opening *o, const struct crypt_file *k,
                                  struct crypt_root *r, struct crypt **out,
                                  struct errinfo *e)
{
    const enum status st = o->key->weak ? ST_OK : crypt_file_strong(k, e);

    return st == ST_OK ? crypt_file_root(k, "", CRYPT_PASSPHRASE, r, out, e) : st;
}

/* The keys of a new database, by a key's file that is there, or is made. */
static enum status make_root(struct opening *o, struct crypt_root *r, struct crypt **out,
                             struct errinfo *e)
{
    struct crypt_file *k = NULL;
    enum status st;

    if (o->key->make == CRYPT_PLAINTEXT) {
        if (!newfile_missing(o->key_path))
            return errinfo_set(
                e, ST_EDENIED,
                "there is a key %.160s: move it away if the database is meant "
                "to be plaintext",
                o->key_path);
        return crypt_make(CRYPT_PLAINTEXT, NULL, 0, r, out, e);
    }
    if (o->key->make == CRYPT_PASSPHRASE && o->key->given != NULL)
        return make_by_phrase(o, o->key->given, r, out, e);
    if ((st = crypt_file_read(o->key_path, &k, e)) == ST_ENOTFOUND &&
        o->key->make == CRYPT_FILE && (st = crypt_file_make(o->key_path, e)) == ST_OK) {
        o->made = true;
        st = crypt_file_read(o->key_path, &k, e);
    }
    if (st == ST_OK && o->key->make == CRYPT_PASSPHRASE)
        st = make_by_phrase(o, k, r, out, e);
    else if (st == ST_OK)
        st = crypt_file_root(k, o->key_path, CRYPT_FILE, r, out, e);
    crypt_file_free(k);
    return st;
}

/* ---- a new database */

static enum status first_entry(struct store *s, struct log_txn *t, enum crypt_kind kind,
                               struct errinfo *e)
{
    static const char *const kept[] = {[CRYPT_PLAINTEXT] = "plaintext",
                                       [CRYPT_FILE] = "file",
                                       [CRYPT_PASSPHRASE] = "passphrase"};
    const enum status st = log_act(&t->by, "", e);

    log_txn_create(t);
    atomic_store(&s->verified, true); /* it has no rows */
    return st == ST_OK ? log_change(t, "create_database", NULL, "", kept[kind], e) : st;
}

/* Tables, keys and the first entry. */
static enum status fill_database(struct store *s, struct opening *o, struct log_txn *t,
                                 struct errinfo *e)
{
    struct crypt_root root;
    enum status st;

    if ((st = sql_create(t->sql, e)) != ST_OK ||
        (st = make_root(o, &root, &s->crypt, e)) != ST_OK ||
        (st = rows_root_write(t->sql, &root, e)) != ST_OK)
        return st;
    t->crypt = s->crypt;
    return first_entry(s, t, o->key->make, e);
}

/* In one transaction; nothing if another process has just done so.  An anchor that is there is
 * another database's, or of one that is lost. */
static enum status make_database(struct store *s, struct opening *o, struct errinfo *e)
{
    struct log_txn t = {.log = &s->log, .how = SQL_SCHEMA, .added = LOGS};
    struct newfile anchor = NEWFILE_NONE;
    int version = 0;
    enum status st;

    if (s->anchor != NULL && !newfile_missing(s->anchor))
        return errinfo_set(e, ST_EEXISTS,
                           "there is an anchor %.160s, but not its database: restore a "
                           "backup (surfacectl restore); if a new one is meant, remove "
                           "the anchor",
                           s->anchor);
    if ((st = sql_begin(s->sql, SQL_SCHEMA, &t.sql, e)) != ST_OK)
        return st;
    if ((st = sql_lock(t.sql, LOG_LOCK_CHANGES, e)) == ST_OK &&
        (st = sql_file_in_place(t.sql, e)) == ST_OK &&
        (st = sql_version_now(t.sql, &version, e)) == ST_OK && version == 0 &&
        (st = fill_database(s, o, &t, e)) == ST_OK && s->anchor != NULL)
        st = log_anchor_prepare(s->anchor, s->crypt,
                                &(struct log_anchor){.end = t.changes}, &anchor, e);
    if (st == ST_OK && version == 0) /* the key stays also if the commit fails */
        return store_commit(s, &t, &anchor, "the database was made", e);
    st = sql_end(t.sql, st, e);
    newfile_close(&anchor);
    if (o->made) /* no database has it */
        (void)unlink(o->key_path);
    return st;
}

/* ---- opening */

/* There is no database, and this program may not make one.  If there is a key, its database is lost. */
static enum status nothing_there(const struct opening *o, struct errinfo *e)
{
    if (!newfile_missing(o->key_path))
        return errinfo_set(
            e, ST_ENOTFOUND,
            "there is no database %.150s, but its key %.150s is there: restore "
            "a backup (surfacectl restore), or make a new one (surfacectl init)",
            o->path, o->key_path);
    return errinfo_set(e, ST_ENOTFOUND,
                       "there is no database %.200s: surfacectl init makes one", o->path);
}

static bool may_make(const struct opening *o, enum store_mode mode)
{
    return mode == STORE_CREATE || (mode == STORE_BEGIN && newfile_missing(o->key_path));
}

static enum status open_keys(struct store *s, const struct opening *o, struct errinfo *e)
{
    struct crypt_root root;
    struct sql_txn *t;
    enum status st;

    if (s->crypt != NULL)
        return ST_OK;
    if ((st = sql_begin(s->sql, SQL_READ, &t, e)) != ST_OK ||
        (st = sql_end(t, rows_root_read(t, &root, e), e)) != ST_OK)
        return st;
    return open_root(o, &root, &s->crypt, e);
}

/* The anchor, and the part of a new one: that of a command which was killed behind its commit. */
struct anchors {
    enum status read, read_left; /* outcomes of reading the two */
    struct log_anchor said, left;
    struct errinfo why, why_left; /* their reasons */
};

static void read_anchors(const char *path, const struct crypt *c, struct anchors *a)
{
    a->read = log_anchor_read(path, c, &a->said, &a->why);
    a->read_left = log_anchor_left(path, c, &a->left, &a->why_left);
}

/* Which of the two names a change that the database has?  The part counts only if it is known that the
 * anchor does not. */
static enum status find_anchor(struct log_txn *t, const struct anchors *a, bool *has,
                               bool *has_left, struct errinfo *e)
{
    enum status st = ST_OK;

    *has = *has_left = false;
    if (log_anchor_unknown(a->read))
        return errinfo_set(e, a->read, "%s", a->why.msg);
    if (a->read == ST_OK)
        st = log_has(t, &a->said.end, has, e);
    if (st != ST_OK || *has)
        return st;
    if (log_anchor_unknown(a->read_left))
        return errinfo_set(e, a->read_left, "%s", a->why_left.msg);
    if (a->read_left == ST_OK && (a->read != ST_OK || a->left.daemon == a->said.daemon))
        st = log_has(t, &a->left.end, has_left, e);
    return st;
}

static enum status say_older(const struct store *s, const struct anchors *a,
                             struct errinfo *e)
{
    if (a->read == ST_ENOTFOUND)
        return errinfo_set(e, ST_EREFUSED,
                           "there is no anchor %.160s: is its disk there?  surfacectl "
                           "accept-state makes one, if the database is the newest",
                           s->anchor);
    if (a->read == ST_EREFUSED)
        return errinfo_set(e, ST_EREFUSED,
                           "%.250s: surfacectl accept-state makes a new one, if the "
                           "database is the newest",
                           a->why.msg);
    return errinfo_set(
        e, ST_EREFUSED,
        "%.120s is older than its anchor says, or another one: it has not the "
        "change %" PRIu64 "; restore the newest backup, or take it as it is "
        "(surfacectl accept-state)",
        s->path, a->said.end.seq);
}

static enum status check_anchors(struct store *s, struct log_txn *t,
                                 const struct anchors *a, bool adopt, struct errinfo *e)
{
    bool has, has_left;
    const enum status st = find_anchor(t, a, &has, &has_left, e);

    if (st != ST_OK)
        return st;
    if (!has && !has_left)
        return say_older(s, a, e);
    s->anchor_left = !has && (!adopt || log_anchor_adopt(s->anchor, NULL) != ST_OK);
    atomic_store(&s->anchored, has ? a->said.end.seq : a->left.end.seq);
    return ST_OK;
}

enum status store_settle_anchor(struct store *s, const char *path, struct errinfo *e)
{
    bool has, has_left;
    struct anchors a;
    struct log_txn t;
    enum status st;

    if (path == NULL)
        return ST_OK;
    read_anchors(path, s->crypt, &a);
    if (a.read_left == ST_ENOTFOUND || a.read_left == ST_EREFUSED)
        return ST_OK; /* there is no part of it */
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = store_end(s, &t, find_anchor(&t, &a, &has, &has_left, e), e);
    return st == ST_OK && has_left ? log_anchor_adopt(path, e) : st;
}

/* Fail now rather than at the first change or request. */
static enum status try_it(struct store *s, enum store_mode mode, struct errinfo *e)
{
    struct anchors a;
    struct log_txn t;
    enum status st;

    if (s->anchor !=
        NULL) { /* whose accesses it writes is known before its first transaction */
        read_anchors(s->anchor, s->crypt, &a);
        s->log.daemon = a.read == ST_OK ? a.said.daemon : a.left.daemon;
    }
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if (s->anchor != NULL)
        st = check_anchors(s, &t, &a, mode != STORE_READ, e);
    st = store_end(s, &t, st, e);
    if (st == ST_OK && mode != STORE_READ)
        sql_file_scrub(s->sql, 0); /* of a process that was killed amid an erasure */
    return st;
}

static enum status open_all(struct store *s, struct opening *o, enum store_mode mode,
                            struct errinfo *e)
{
    const enum sql_open how = mode == STORE_READ    ? SQL_OPEN_READ
                              : mode == STORE_ALONE ? SQL_OPEN_ALONE
                              : may_make(o, mode)   ? SQL_OPEN_CREATE
                                                    : SQL_OPEN_WRITE;
    enum status st;

    if (sodium_init() < 0)
        return errinfo_set(e, ST_EINTERNAL, "the cryptographic library does not start");
    if ((st = sql_open(s->path, how, &s->sql, e)) == ST_ENOTFOUND)
        return nothing_there(o, e);
    if (st == ST_OK && sql_version(s->sql) == 0)
        st = may_make(o, mode) ? make_database(s, o, e) : nothing_there(o, e);
    if (st != ST_OK || (st = open_keys(s, o, e)) != ST_OK)
        return st;
    return try_it(s, mode, e);
}

enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out, struct errinfo *e)
{
    static const struct store_key usual = {.make = CRYPT_FILE};
    struct opening o = {.path = path, .key = key != NULL ? key : &usual};
    const size_t n = strlen(path) + sizeof ".key";
    struct store *s = calloc(1, sizeof *s);
    enum status st = ST_OK;

    *out = NULL;
    if (s == NULL)
        return errinfo_memory(e);
    log_init(&s->log);
    (void)pthread_mutex_init(&s->anchor_lock, NULL);
    (void)pthread_mutex_init(&s->anchor_why_lock, NULL);
    store_use_model(s, NULL);
    if (o.key->path == NULL && o.key->given == NULL && !o.key->plaintext &&
        store_on_server(path))
        st = errinfo_set(e, ST_EINVAL,
                         "a database on a server has no usual place for its key: name "
                         "it (--key FILE)");
    if (o.key->path != NULL)
        o.key_path = strdup(o.key->path);
    else if ((o.key_path = malloc(n)) != NULL)
        (void)snprintf(o.key_path, n, "%s.key", path);
    if (st == ST_OK &&
        ((s->path = strdup(path)) == NULL || o.key_path == NULL ||
         (o.key->anchor != NULL && (s->anchor = strdup(o.key->anchor)) == NULL)))
        st = errinfo_memory(e);
    if (st == ST_OK)
        st = open_all(s, &o, mode, e);
    free(o.key_path);
    if (st != ST_OK) {
        store_close(s);
        return st;
    }
    s->open = true;
    *out = s;
    return ST_OK;
}

void store_close(struct store *s)
{
    if (s == NULL)
        return;
    sql_close(s->sql);
    crypt_free(s->crypt);
    log_free(&s->log);
    (void)pthread_mutex_destroy(&s->anchor_lock);
    (void)pthread_mutex_destroy(&s->anchor_why_lock);
    free(s->anchor);
    free(s->path);
    free(s);
}

void store_use_model(struct store *s, const struct surface_model *m)
{
    s->model = m;
    surface_engine(m, s->made_by);
}

const char *store_made_by(const struct store *s)
{
    return s->made_by;
}

enum status store_ready(struct store *s, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, ST_OK, e);
}

enum status store_verify(struct store *s, store_report *report, void *arg,
                         struct errinfo *e)
{
    return store_txn_verify_alone(s, report, arg, e);
}

bool store_refused(struct store *s, struct errinfo *e)
{
    return store_txn_refused(s, e);
}

bool store_behind(struct store *s)
{
    return atomic_load(&s->behind);
}

void store_follow(struct store *s)
{
    const struct store_use nothing = {.subject = 0};
    struct log_txn t;
    enum status st;

    if (s->anchor == NULL || log_newest(&s->log).seq <= atomic_load(&s->anchored) ||
        store_begin_use(s, NULL, SQL_WRITE, &nothing, &t, NULL) != ST_OK)
        return;
    st = sql_settle(t.sql, NULL);
    t.settled = st == ST_OK;
    (void)store_end(s, &t, st, NULL);
}

bool store_anchor_fault(struct store *s, struct errinfo *e)
{
    bool behind;

    (void)pthread_mutex_lock(&s->anchor_why_lock);
    behind = s->anchor_why.code != ST_OK;
    if (behind && e != NULL)
        *e = s->anchor_why;
    (void)pthread_mutex_unlock(&s->anchor_why_lock);
    return behind;
}

enum status store_last_change(struct store *s, struct log_end *out, struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    memset(out, 0, sizeof *out);
    if (st != ST_OK)
        return st;
    *out = t.changes;
    return store_end(s, &t, ST_OK, e);
}

/* ---- a look from outside */

bool store_in_use(const char *path, int64_t *pid)
{
    return sql_file_in_use(path, pid);
}

bool store_on_server(const char *path)
{
    return sql_open_is_url(path);
}

enum status store_root(const char *path, struct crypt_root *root, struct errinfo *e)
{
    struct sql_txn *t;
    struct sql *d;
    enum status st;

    if ((st = sql_open(path, SQL_OPEN_READ, &d, e)) != ST_OK)
        return st;
    if (sql_version(d) == 0)
        st = errinfo_set(e, ST_ENOTFOUND, "%s is empty: it has to be initialised", path);
    else if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK)
        st = sql_end(t, rows_root_read(t, root, e), e);
    sql_close(d);
    return st;
}

enum status store_kind(const char *path, enum crypt_kind *kind, struct errinfo *e)
{
    struct crypt_root root = {.kind = CRYPT_PLAINTEXT};
    const enum status st = store_root(path, &root, e);

    *kind = st == ST_OK ? root.kind : CRYPT_PLAINTEXT;
    return st;
}

/* ---- statistics, room */

static enum status store_open_count(struct sql_txn *t, const char *text,
                                    uint64_t *const out[], int n, struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = sql_query(t, text, NULL, 0, &r, e);

    if (st == ST_OK && sql_next(r))
        for (int i = 0; i < n; i++)
            *out[i] = (uint64_t)sql_column(r, i).i;
    return sql_done(r, st, e);
}

enum status store_stats(struct store *s, bool sizes, struct store_stats *out,
                        struct errinfo *e)
{
    uint64_t *const rows[] = {&out->subjects, &out->templates,    &out->tokens,
                              &out->devices,  &out->calibrations, &out->events};
    uint64_t *const bytes[] = {&out->points, &out->template_bytes};
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    out->schema = (uint32_t)sql_version(s->sql);
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = store_open_count(
        t.sql,
        "SELECT (SELECT count(*) FROM subjects), (SELECT count(*) FROM templates), "
        "(SELECT count(*) FROM tokens), (SELECT count(*) FROM devices), "
        "(SELECT count(*) FROM calibrations), "
        "(SELECT coalesce(max(seq), 0) FROM change_log) + (WITH RECURSIVE d(i) AS "
        "(SELECT 0 UNION ALL SELECT i + 1 FROM d "
        "WHERE i < (SELECT max(daemon) FROM access_log)) "
        "SELECT CAST(coalesce(sum("
        "(SELECT max(seq) FROM access_log WHERE daemon = i) + 1 - "
        "(SELECT min(seq) FROM access_log WHERE daemon = i)), 0) AS bigint) FROM d)",
        rows, 6, e);
    if (st == ST_OK && sizes &&
        (st = store_open_count(
             t.sql,
             "SELECT (SELECT CAST(coalesce(sum(points), 0) AS bigint) "
             "FROM templates), "
             "(SELECT CAST(coalesce(sum(length(face) + length(mesh)), 0) AS bigint) FROM faces)",
             bytes, 2, e)) == ST_OK)
        st = sql_bytes(t.sql, &out->file_bytes, e);
    return store_end(s, &t, st, e);
}

enum status store_vacuum(struct store *s, struct errinfo *e)
{
    enum status st = store_verify(s, NULL, NULL, e); /* each page is written */

    if (st == ST_OK && (st = sql_file_compact(s->sql, e)) == ST_OK)
        store_scrub(s);
    return st;
}
