#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "store_sqlite.h"

enum { /* the columns of EVENT_COLUMNS, and of a checkpoint behind them */
       COL_SEQ,
       COL_AT,
       COL_KIND,
       COL_ACTOR,
       COL_SUBJECT,
       COL_TEMPLATE,
       COL_OUTCOME,
       COL_HASH,
       COL_MARK
};

/* ---- rows */

/* An entry in the form that it is hashed in as well: ref has the subject's bytes. */
struct row {
    struct store_audit_entry entry;
    unsigned char ref[STORE_SEAL_REF], hash[STORE_CHAIN_HASH];
    size_t nref;
};

static bool read_row(sqlite3_stmt *stmt, struct row *r)
{
    struct store_audit_entry *a = &r->entry;
    const void *ref;

    memset(r, 0, sizeof *r);
    a->seq = (uint64_t)sqlite3_column_int64(stmt, COL_SEQ);
    if (sqlite3_column_bytes(stmt, COL_SUBJECT) != 0) {
        if ((ref = store_sqlite_blob(stmt, COL_SUBJECT, STORE_SEAL_REF, STORE_SEAL_REF,
                                     &r->nref)) == NULL)
            return false;
        memcpy(r->ref, ref, r->nref);
    }
    if (!store_sqlite_text(stmt, COL_AT, a->at, sizeof a->at) ||
        !store_sqlite_text(stmt, COL_KIND, a->kind, sizeof a->kind) ||
        !store_sqlite_text(stmt, COL_ACTOR, a->actor, sizeof a->actor) ||
        !store_sqlite_text(stmt, COL_TEMPLATE, a->template_id, sizeof a->template_id) ||
        !store_sqlite_text(stmt, COL_OUTCOME, a->outcome, sizeof a->outcome) ||
        !store_sqlite_bytes(stmt, COL_HASH, r->hash, sizeof r->hash))
        return false;
    (void)sodium_bin2hex(a->ref, sizeof a->ref, r->ref, r->nref);
    (void)sodium_bin2hex(a->hash, sizeof a->hash, r->hash, sizeof r->hash);
    return true;
}

static enum status read_entry(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              void *out, struct errinfo *e)
{
    struct row r;

    (void)c; /* nothing of it is sealed */
    if (!read_row(stmt, &r))
        return errinfo_set(e, ST_ECORRUPT, "entry %lld of the audit log is damaged",
                           (long long)r.entry.seq);
    memcpy(out, &r.entry, sizeof r.entry);
    return ST_OK;
}

static bool read_mark(sqlite3_stmt *stmt, int col, struct store_chain_mark *m)
{
    return store_sqlite_text(stmt, col, m->at, sizeof m->at) &&
           store_sqlite_bytes(stmt, col + 1, m->hash, sizeof m->hash) &&
           store_sqlite_bytes(stmt, col + 2, m->signature, sizeof m->signature);
}

static enum status list_mark(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                             void *out, struct errinfo *e)
{
    struct store_audit_mark *a = out;
    struct store_chain_mark m;

    (void)c;
    memset(a, 0, sizeof *a);
    a->seq = (uint64_t)sqlite3_column_int64(stmt, 0);
    if (!read_mark(stmt, 1, &m))
        return errinfo_set(e, ST_ECORRUPT, "the checkpoint at entry %lld is damaged",
                           (long long)a->seq);
    memcpy(a->at, m.at, sizeof a->at);
    (void)sodium_bin2hex(a->hash, sizeof a->hash, m.hash, sizeof m.hash);
    (void)sodium_bin2hex(a->signature, sizeof a->signature, m.signature,
                         sizeof m.signature);
    return ST_OK;
}

/* ---- names */

struct name {
    char ref[33], subject[STORE_SUBJECT_MAX + 1];
};

static int by_ref(const void *a, const void *b)
{
    return strcmp(((const struct name *)a)->ref, ((const struct name *)b)->ref);
}

/* Who is damaged has no name here. */
static enum status read_name(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                             void *out, struct errinfo *e)
{
    unsigned char ref[STORE_SEAL_REF];
    struct name *name = out;
    struct store_seal_key k;
    struct store_subject who;

    (void)e;
    memset(name, 0, sizeof *name);
    if (store_sqlite_subject_who(c, stmt, 0, &who, &k)) {
        store_seal_ref(c->vault, who.id, ref);
        (void)sodium_bin2hex(name->ref, sizeof name->ref, ref, sizeof ref);
        memcpy(name->subject, who.id, sizeof name->subject);
    }
    sodium_memzero(&k, sizeof k);
    return ST_OK;
}

static enum status find_names(struct store_sqlite_conn *c, struct store_audit_entry *a,
                              size_t n, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    void *list = NULL;
    size_t count = 0;
    enum status st = store_sqlite_prepare(c, SQL_SUBJECT_ALL, &stmt, e);

    if (st != ST_OK ||
        (st = store_sqlite_rows(c, stmt, read_name, sizeof(struct name),
                                "cannot read the subjects", &list, &count, e)) != ST_OK ||
        count == 0)
        return st;
    qsort(list, count, sizeof(struct name), by_ref);
    for (size_t i = 0; i < n; i++) {
        struct name wanted, *found;

        if (a[i].ref[0] == '\0')
            continue;
        memcpy(wanted.ref, a[i].ref, sizeof wanted.ref);
        found = bsearch(&wanted, list, count, sizeof wanted, by_ref);
        if (found != NULL)
            memcpy(a[i].subject, found->subject, sizeof a[i].subject);
    }
    free(list);
    return ST_OK;
}

/* ---- lists */

static int bind_text(sqlite3_stmt *stmt, int at, const char *text)
{
    return store_sqlite_bind_or(stmt, at, text != NULL ? text : "");
}

static int bind_ref(const struct store_sqlite_conn *c, sqlite3_stmt *stmt, int at,
                    const char *subject)
{
    unsigned char ref[STORE_SEAL_REF];

    if (subject == NULL)
        return sqlite3_bind_null(stmt, at);
    store_seal_ref(c->vault, subject, ref);
    return store_sqlite_bind_bytes(stmt, at, ref, sizeof ref);
}

static enum status list(struct store_sqlite_conn *c, const struct store_audit_filter *f,
                        void **out, size_t *n, struct errinfo *e)
{
    const uint64_t after = f->after <= INT64_MAX ? f->after : INT64_MAX;
    const int64_t limit = f->limit != 0 && f->limit < INT64_MAX ? (int64_t)f->limit : -1;
    sqlite3_stmt *stmt;
    enum status st =
        store_sqlite_prepare(c, f->newest ? SQL_EVENT_NEWEST : SQL_EVENT_LIST, &stmt, e);

    if (st != ST_OK)
        return st;
    if (sqlite3_bind_int64(stmt, 1, (sqlite3_int64)after) != SQLITE_OK ||
        bind_ref(c, stmt, 2, f->subject) != SQLITE_OK ||
        bind_text(stmt, 3, f->kind) != SQLITE_OK ||
        bind_text(stmt, 4, f->since) != SQLITE_OK ||
        sqlite3_bind_int64(stmt, 5, limit) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot read the events", e);
    return store_sqlite_rows(c, stmt, read_entry, sizeof(struct store_audit_entry),
                             "cannot read the events", out, n, e);
}

enum status store_sqlite_audit_list(struct store *s,
                                    const struct store_audit_filter *filter,
                                    struct store_audit_entry **out, size_t *n,
                                    struct errinfo *e)
{
    struct store_sqlite_conn *c;
    void *entries = NULL;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = list(c, filter, &entries, n, e)) == ST_OK && filter->names)
        st = find_names(c, entries, *n, e);
    store_sqlite_done(s, c);
    if (st != ST_OK) {
        free(entries);
        entries = NULL;
        *n = 0;
    }
    *out = entries;
    return st;
}

enum status store_sqlite_audit_marks(struct store *s, struct store_audit_mark **out,
                                     size_t *n, struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *marks = NULL;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_MARK_LIST, &stmt, e)) == ST_OK)
        st = store_sqlite_rows(c, stmt, list_mark, sizeof **out,
                               "cannot read the checkpoints", &marks, n, e);
    store_sqlite_done(s, c);
    *out = marks;
    return st;
}

enum status store_sqlite_audit_public(struct store *s, char public_key[65],
                                      struct errinfo *e)
{
    unsigned char public[VAULT_KEY];
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    vault_public(c->vault, public);
    (void)sodium_bin2hex(public_key, 65, public, sizeof public);
    store_sqlite_done(s, c);
    return ST_OK;
}

static enum status read_erased(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                               void *out, struct errinfo *e)
{
    unsigned char lookup[VAULT_HASH];
    struct store_erased *one = out;

    (void)c;
    if (!store_sqlite_bytes(stmt, 0, lookup, sizeof lookup) ||
        !store_sqlite_text(stmt, 1, one->at, sizeof one->at))
        return errinfo_set(e, ST_ECORRUPT, "the list of the erased is damaged");
    (void)sodium_bin2hex(one->lookup, sizeof one->lookup, lookup, sizeof lookup);
    return ST_OK;
}

enum status store_sqlite_audit_erased(struct store *s, const char *subject,
                                      struct store_erased **out, size_t *n,
                                      struct errinfo *e)
{
    struct store_sqlite_conn *c;
    sqlite3_stmt *stmt;
    void *erased = NULL;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_prepare(c, SQL_ERASED_LIST, &stmt, e)) != ST_OK)
        goto out;
    if ((subject == NULL ? sqlite3_bind_null(stmt, 1)
                         : store_sqlite_bind_subject(c, stmt, 1, subject)) != SQLITE_OK)
        st = store_sqlite_fail(c, "cannot read the list of the erased", e);
    else
        st = store_sqlite_rows(c, stmt, read_erased, sizeof **out,
                               "cannot read the list of the erased", &erased, n, e);
out:
    store_sqlite_done(s, c);
    *out = erased;
    return st;
}

/* ---- signing */

enum status store_sqlite_audit_sign(struct store *s, const struct store_act *by,
                                    const char *kind, struct store_audit_mark *out,
                                    struct errinfo *e)
{
    struct store_sqlite_conn *c;
    unsigned char hash[STORE_CHAIN_HASH];
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_write(s, true, &c, e)) != ST_OK)
        return st;
    if ((st = store_sqlite_event_add(c, by, kind, "", "", "", e)) != ST_OK ||
        (st = store_sqlite_event_end(c, &out->seq, hash, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_MARK_GET, &stmt, e)) != ST_OK)
        goto out;
    if (sqlite3_bind_int64(stmt, 1, (sqlite3_int64)out->seq) != SQLITE_OK ||
        sqlite3_step(stmt) != SQLITE_ROW)
        st = store_sqlite_fail(c, "cannot sign the audit log", e);
    else
        st = list_mark(c, stmt, out, e);
    (void)sqlite3_reset(stmt);
out:
    return store_sqlite_written(s, st, e);
}

/* ---- verifying */

static void step(struct store_chain_walk *w, sqlite3_stmt *stmt)
{
    struct store_chain_mark m = {0};
    struct row r;
    const bool sound = read_row(stmt, &r);
    const struct store_chain_entry entry = {.seq = r.entry.seq,
                                            .at = r.entry.at,
                                            .kind = r.entry.kind,
                                            .actor = r.entry.actor,
                                            .subject = r.ref,
                                            .nsubject = r.nref,
                                            .template_id = r.entry.template_id,
                                            .outcome = r.entry.outcome};

    if (sound)
        store_chain_step(w, &entry, r.hash);
    else
        store_chain_damaged(w, r.entry.seq);
    m.seq = r.entry.seq;
    if (sqlite3_column_type(stmt, COL_MARK) != SQLITE_NULL) {
        if (read_mark(stmt, COL_MARK, &m))
            store_chain_pass(w, &m);
        else
            store_chain_problem(w, m.seq, "its checkpoint is damaged");
    } else if (sound && store_chain_due(m.seq, entry.kind)) {
        store_chain_problem(w, m.seq, "its checkpoint is missing");
    }
}

static enum status walk(struct store_sqlite_conn *c, struct store_chain_walk *w,
                        uint64_t *entries, struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_EVENT_EACH, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        step(w, stmt);
        ++*entries;
    }
    if (rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the events", e);
    (void)sqlite3_reset(stmt);
    return st;
}

/* Checkpoints of entries that are not there; the signature tells whether they ever were. */
static enum status walk_alone(struct store_sqlite_conn *c, struct store_chain_walk *w,
                              struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_MARK_ALONE, &stmt, e);
    int rc;

    if (st != ST_OK)
        return st;
    while ((rc = sqlite3_step(stmt)) == SQLITE_ROW) {
        struct store_chain_mark m = {.seq = (uint64_t)sqlite3_column_int64(stmt, 0)};

        if (!read_mark(stmt, 1, &m))
            store_chain_problem(w, m.seq, "its checkpoint is damaged");
        else
            store_chain_pass(w, &m);
    }
    if (rc != SQLITE_DONE)
        st = store_sqlite_fail(c, "cannot read the checkpoints", e);
    (void)sqlite3_reset(stmt);
    return st;
}

enum status store_sqlite_audit_verify(struct store *s, store_chain_report *report,
                                      void *arg, struct store_audit *out,
                                      struct errinfo *e)
{
    unsigned char public[VAULT_KEY], hash[STORE_CHAIN_HASH];
    struct store_chain_walk w;
    struct store_sqlite_conn *c;
    struct errinfo why = {0};
    uint64_t seq;
    enum status st;

    if ((st = store_sqlite_read(s, &c, e)) != ST_OK)
        return st;
    vault_public(c->vault, public);
    store_chain_walk(&w, public, report, arg);
    if ((st = walk(c, &w, &out->entries, e)) != ST_OK)
        goto out;
    if ((st = store_sqlite_event_end(c, &seq, hash, &why)) == ST_OK) {
        store_chain_stop(&w, seq, hash);
    } else if (st == ST_ECORRUPT) {
        store_chain_stop(&w, w.seq, w.hash);
        store_chain_problem(&w, w.seq, why.msg);
    } else {
        (void)errinfo_set(e, st, "%s", why.msg);
        goto out;
    }
    st = walk_alone(c, &w, e);
    out->checkpoints = w.marks;
    out->problems = w.problems;
    out->first = w.first;
out:
    store_sqlite_done(s, c);
    return st;
}
