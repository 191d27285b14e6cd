#include "store_open.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "errinfo.h"
#include "model.h"
#include "newfile.h"
#include "row_event.h"
#include "sql_file.h"
#include "store_rules.h"
#include "store_txn.h"

/* ---- tables made and upgraded */

/* A database has its first key: by whom is not known here. */
static enum status first_key(struct store_txn *t, struct errinfo *e)
{
    static const char *const kept[] = {[VAULT_PLAINTEXT] = "plaintext",
                                       [VAULT_FILE] = "file",
                                       [VAULT_PASSPHRASE] = "passphrase"};
    struct store_vaults *v = &t->store->vaults;
    struct store_act by;
    enum status st;

    if ((st = store_vault_new(v, t->sql, &t->held, e)) != ST_OK)
        return st;
    t->vault = t->held->vault;
    if ((st = row_event_begin(t, e)) != ST_OK ||
        (st = store_rules_act(&by, "", e)) != ST_OK)
        return st;
    return row_event_signs(t, &by, "create_key", t->vault, kept[v->make], e);
}

/* It is announced before the database is there, so that neither is without the other. */
static enum status first_anchor(struct store_txn *t, struct anchor_end *end,
                                struct errinfo *e)
{
    const char *path = t->store->anchor.path;
    enum status st;

    if (path == NULL)
        return errinfo_set(e, ST_EINVAL, "a copy is not made anew");
    if (anchor_used(path))
        return errinfo_set(
            e, ST_EEXISTS,
            "there is an anchor %.160s, but not its database: restore a backup "
            "(surfacectl restore); if a new one is meant, remove the anchor",
            path);
    st = store_anchor_end(t->sql, t->vault, end, e);
    return st == ST_OK ? anchor_announce(path, t->vault, end, e) : st;
}

static enum status verify_copy(const char *path, int version, struct errinfo *e);

/* A verified copy of the database of that version, for PATH.vVERSION.bak. */
static enum status copy_old(const char *path, int version, struct newfile *n,
                            struct errinfo *e)
{
    const size_t len = strlen(path) + 32;
    char *name = malloc(len);
    struct sql_txn *t;
    struct sql *d;
    enum status st;

    if (name == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    (void)snprintf(name, len, "%s.v%d.bak", path, version);
    st = newfile_open(name, n, e);
    free(name);
    if (st != ST_OK || (st = sql_open(path, SQL_OPEN_LOOK, &d, e)) != ST_OK)
        return st;
    if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK)
        st = sql_end(t, sql_file_copy(t, n->part, e), e);
    sql_close(d);
    return st == ST_OK ? verify_copy(n->part, version, e) : st;
}

static void first_problem(void *arg, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(first, ST_ECORRUPT, "%s", line);
}

static enum status verify_copy(const char *path, int version, struct errinfo *e)
{
    struct errinfo first = {ST_OK, ""};
    struct sql_txn *t;
    struct sql *d;
    int found = 0;
    enum status st;

    if ((st = sql_open(path, SQL_OPEN_LOOK, &d, e)) != ST_OK)
        return st;
    if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK) {
        if ((st = sql_version_now(t, &found, e)) == ST_OK)
            st = sql_file_check(t, first_problem, &first, e);
        if (st == ST_OK && (found != version || first.code != ST_OK))
            st = errinfo_set(e, ST_ECORRUPT,
                             "the database is damaged: it is not upgraded");
        st = sql_end(t, st, e);
    }
    sql_close(d);
    return st;
}

/* Create the tables, or bring those of an older version up to this one, in one transaction;
 * nothing if another process has just done so.  The copy of what there was gets its name when
 * the steps have been gone and before they count. */
static enum status make_schema(struct store *s, struct errinfo *e)
{
    struct newfile old = NEWFILE_NONE;
    struct store_txn t = {.store = s, .how = SQL_SCHEMA};
    struct anchor_end end;
    int version = 0;
    bool kept = false, announced = false;
    enum status st = sql_begin(s->sql, SQL_SCHEMA, &t.sql, e);

    if (st != ST_OK)
        return st;
    if ((st = sql_version_now(t.sql, &version, e)) == ST_OK && version < sql_newest()) {
        if (version > 0)
            st = copy_old(s->path, version, &old, e);
        if (st == ST_OK)
            st = sql_upgrade(t.sql, e);
        if (st == ST_OK && version == 0)
            announced = (st = first_key(&t, e)) == ST_OK &&
                        (st = first_anchor(&t, &end, e)) == ST_OK;
        else if (st == ST_OK)
            kept = (st = newfile_commit(&old, e)) == ST_OK;
    }
    if ((st = sql_end(t.sql, st, e)) != ST_OK && kept)
        (void)unlink(old.path);
    if (announced && st == ST_OK)
        st = anchor_set(s->anchor.path, t.vault, &end, false, e);
    else if (announced)
        (void)unlink(s->anchor.path);
    store_vault_release(&s->vaults, t.held);
    newfile_close(&old);
    if (st != ST_OK)
        store_vault_undo(&s->vaults);
    return st;
}

/* ---- opening */

/* What is left of a database, or is there for one: its key or its anchor; NULL: neither. */
static const char *find_trace(const struct store *s)
{
    if (s->anchor.path != NULL && access(s->anchor.path, F_OK) == 0)
        return s->anchor.path;
    return access(s->vaults.path, F_OK) == 0 ? s->vaults.path : NULL;
}

/* There is no database, and this program may not make one.  Where it had one, that is lost. */
static enum status nothing_there(const struct store *s, struct errinfo *e)
{
    const char *trace = find_trace(s);

    if (trace != NULL)
        return errinfo_set(
            e, ST_ENOTFOUND,
            "there is no database %.150s, but its %s %.150s is there: restore "
            "a backup (surfacectl restore), or make a new one (surfacectl init)",
            s->path, trace == s->anchor.path ? "anchor" : "key", trace);
    return errinfo_set(e, ST_ENOTFOUND,
                       "there is no database %.200s: surfacectl init makes one", s->path);
}

static enum status need_version(struct store *s, enum store_mode mode, struct errinfo *e)
{
    const int version = sql_version(s->sql);

    if (version == sql_newest())
        return ST_OK;
    if (version == 0 &&
        (mode == STORE_CREATE || (mode == STORE_BEGIN && find_trace(s) == NULL)))
        return make_schema(s, e);
    if (version == 0)
        return nothing_there(s, e);
    if (mode == STORE_MIGRATE)
        return make_schema(s, e);
    return errinfo_set(e, ST_EVERSION,
                       "%s has schema version %d, this program needs %d: "
                       "surfacectl migrate upgrades it",
                       s->path, version, sql_newest());
}

/* With the key that a transaction has found before. */
static enum status check_anchor(struct store *s, bool settle, struct errinfo *e)
{
    struct store_vault *known = store_vault_take(&s->vaults);
    struct anchor said;
    struct store_txn t;
    enum status st = store_anchor_ask(&s->anchor, known->vault, s->path, &said, e);

    store_vault_release(&s->vaults, known);
    if (st != ST_OK || (st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = store_anchor_check(&s->anchor, t.sql, t.vault, s->path, &said, settle, e);
    return store_txn_end(&t, st, e);
}

/* Fail now rather than at the first change or request. */
static enum status try_it(struct store *s, enum store_mode mode, struct errinfo *e)
{
    struct store_txn t;
    enum status st;

    if (mode != STORE_READ) {
        if ((st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
            return st;
        (void)store_txn_end(&t, ST_EDENIED, NULL); /* rolled back */
    }
    if ((st = store_txn_seen(s, e)) != ST_OK || s->anchor.path == NULL)
        return st;
    return check_anchor(s, mode != STORE_READ, e);
}

enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out, struct errinfo *e)
{
    static const struct store_key usual = {.make = VAULT_FILE};
    enum sql_open how = SQL_OPEN_WRITE;
    struct store *s = calloc(1, sizeof *s);
    bool fresh = false;
    enum status st;

    *out = NULL;
    if (s == NULL || (s->path = strdup(path)) == NULL) {
        free(s);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    store_use_model(s, NULL);
    store_head_init(&s->heads);
    if (key == NULL)
        key = &usual;
    s->anchor.serving = -1;
    if ((st = store_vault_init(&s->vaults, s->path, key, e)) == ST_OK &&
        (st = store_anchor_init(&s->anchor, key, s->vaults.path,
                                key->of != NULL ? key->of : path, e)) == ST_OK &&
        sodium_init() < 0)
        st = errinfo_set(e, ST_EINTERNAL, "the cryptographic library does not start");
    if (mode == STORE_READ)
        how = SQL_OPEN_READ;
    else if (mode == STORE_CREATE || (mode == STORE_BEGIN && find_trace(s) == NULL))
        how = SQL_OPEN_CREATE;
    if (st == ST_OK && (st = sql_open(path, how, &s->sql, e)) == ST_ENOTFOUND)
        st = nothing_there(s, e);
    if (st == ST_OK) {
        fresh = sql_version(s->sql) == 0;
        st = need_version(s, mode, e);
    }
    if (st == ST_OK && (st = try_it(s, mode, e)) == ST_OK && mode != STORE_READ && !fresh)
        sql_file_scrub(s->sql, 0); /* of a process that was killed amid an erasure */
    if (st == ST_OK) {
        s->open = true;
        *out = s;
    } else {
        store_close(s);
    }
    return st;
}

/* A daemon's clean stop; another one may go on. */
static void serve_no_more(struct store *s)
{
    struct store_txn t;

    if (s->anchor.serving < 0 || store_txn_begin(s, SQL_READ, &t, NULL) != ST_OK)
        return;
    (void)anchor_mark(s->anchor.path, t.vault, !anchor_serves_alone(s->anchor.serving),
                      NULL);
    (void)store_txn_end(&t, ST_OK, NULL);
}

void store_close(struct store *s)
{
    if (s == NULL)
        return;
    if (s->open)
        serve_no_more(s);
    sql_close(s->sql);
    store_anchor_free(&s->anchor);
    store_vault_free(&s->vaults);
    store_head_free(&s->heads);
    free(s->path);
    free(s);
}

void store_use_model(struct store *s, const struct model *m)
{
    s->model = m != NULL ? m : &model_default;
    face_engine(s->model, s->made_by);
}

const struct model *store_model(const struct store *s)
{
    return s->model;
}

const char *store_made_by(const struct store *s)
{
    return s->made_by;
}

enum status store_ready(struct store *s, struct errinfo *e)
{
    struct store_txn t;
    enum status st;

    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, sql_file_ready(t.sql, e), e);
}

bool store_refused(struct store *s, struct errinfo *e)
{
    if (!atomic_load(&s->refusal.stands))
        return false;
    *e = s->refusal.why;
    return true;
}

/* ---- a look from outside */

bool store_in_use(const char *path, int64_t *pid)
{
    return sql_file_in_use(path, pid);
}

enum status store_kind(const char *path, enum vault_kind *kind, struct errinfo *e)
{
    struct vault_root root;
    struct sql_txn *t;
    struct sql *d;
    enum status st;

    *kind = VAULT_PLAINTEXT;
    if ((st = sql_open(path, SQL_OPEN_LOOK, &d, e)) != ST_OK)
        return st;
    if (sql_version(d) == 0) {
        st = errinfo_set(e, ST_ENOTFOUND, "%s is empty: it has to be initialised", path);
    } else if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK &&
               (st = sql_end(t, store_vault_read(t, &root, e), e)) == ST_OK) {
        *kind = root.kind;
    }
    sql_close(d);
    return st;
}

static enum status count_rows(struct sql_txn *t, struct store_look *out,
                              struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = sql_query(t,
                                     "SELECT (SELECT count(*) FROM subjects), "
                                     "(SELECT count(*) FROM templates)",
                                     NULL, 0, &r, e);

    if (st == ST_OK && sql_next(r)) {
        out->subjects = (uint64_t)sql_column(r, 0).i;
        out->templates = (uint64_t)sql_column(r, 1).i;
    }
    return sql_done(r, st, e);
}

enum status store_look(const char *path, struct store_look *out, struct errinfo *e)
{
    struct sql_txn *t;
    struct sql *d;
    enum status st;

    memset(out, 0, sizeof *out);
    out->newest = sql_newest();
    if ((st = sql_open(path, SQL_OPEN_LOOK, &d, e)) != ST_OK)
        return st;
    out->version = sql_version(d);
    if ((st = sql_begin(d, SQL_READ, &t, e)) == ST_OK) {
        if ((st = sql_file_bytes(t, &out->bytes, e)) == ST_OK && out->version > 0)
            st = count_rows(t, out, e);
        st = sql_end(t, st, e);
    }
    sql_close(d);
    return st;
}

/* ---- statistics, room */

enum status store_stats(struct store *s, struct store_stats *out, struct errinfo *e)
{
    uint64_t *const count[] = {&out->subjects,       &out->templates, &out->points,
                               &out->template_bytes, &out->events,    &out->tokens};
    struct sql_rows *r;
    struct store_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    out->schema = (uint32_t)sql_newest();
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = sql_query(t.sql,
                   "SELECT (SELECT count(*) FROM subjects), count(*), "
                   "CAST(coalesce(sum(points), 0) AS bigint), "
                   "CAST(coalesce(sum(length(model)), 0) AS bigint), "
                   "(SELECT count(*) FROM events), (SELECT count(*) FROM tokens) "
                   "FROM templates",
                   NULL, 0, &r, e);
    if (st == ST_OK && sql_next(r))
        for (int i = 0; i < (int)(sizeof count / sizeof *count); i++)
            *count[i] = (uint64_t)sql_column(r, i).i;
    if ((st = sql_done(r, st, e)) == ST_OK)
        st = sql_file_bytes(t.sql, &out->file_bytes, e);
    return store_txn_end(&t, st, e);
}

enum status store_vacuum(struct store *s, struct errinfo *e)
{
    const enum status st = sql_file_compact(s->sql, e);

    if (st == ST_OK)
        store_txn_scrub(s);
    return st;
}
