#include "store.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "log_row.h"
#include "rows_subject.h"
#include "sql_read.h"
#include "store_txn.h"
#include "utc.h"

/* ---- lists */

static enum status check_filter(const struct store_audit_filter *f, struct errinfo *e)
{
    if (f->wanted.kind != NULL && !ident_printable(f->wanted.kind, 1, LOG_TEXT))
        return errinfo_set(e, ST_EINVAL, "a kind is 1 to %d printable characters",
                           LOG_TEXT);
    if (f->wanted.since != NULL &&
        !ident_consists(f->wanted.since, "0123456789-T:.Z", 4, 24))
        return errinfo_set(e, ST_EINVAL,
                           "a time is like 2026-11-21 or 2026-11-21T14:30, not %.40s",
                           f->wanted.since);
    return f->subject != NULL ? ident_subject(f->subject, e) : ST_OK;
}

/* The names of subjects that are still enrolled; a damaged row has none here. */
static enum status find_name(struct log_txn *t, struct store_audit_entry *a,
                             struct errinfo *e)
{
    struct rows_subject of;
    enum status st;

    if (sodium_is_zero(a->entry.uid, sizeof a->entry.uid))
        return ST_OK;
    if ((st = rows_subject_get(t, a->entry.uid, &of, e)) == ST_OK)
        memcpy(a->subject, of.one.id, sizeof a->subject);
    sodium_memzero(&of, sizeof of);
    return st == ST_ENOTFOUND || st == ST_ECORRUPT ? ST_OK : st;
}

/* Both in the order of their writing: a change says how many accesses came before it. */
static void merge(struct log_entry *const entry[LOGS], const size_t n[LOGS], size_t skip,
                  struct store_audit_entry *out)
{
    size_t at[LOGS] = {0};

    for (size_t i = 0; i < n[LOG_CHANGES] + n[LOG_ACCESSES]; i++) {
        const struct log_entry *change = entry[LOG_CHANGES] + at[LOG_CHANGES];
        const struct log_entry *access = entry[LOG_ACCESSES] + at[LOG_ACCESSES];
        const bool is_access =
            at[LOG_ACCESSES] < n[LOG_ACCESSES] &&
            (at[LOG_CHANGES] == n[LOG_CHANGES] || access->seq <= change->accesses.seq);

        at[is_access ? LOG_ACCESSES : LOG_CHANGES]++;
        if (i >= skip)
            (out++)->entry = is_access ? *access : *change;
    }
}

static enum status list(struct log_txn *t, const struct store_audit_filter *filter,
                        struct store_audit_entry **out, size_t *n, struct errinfo *e)
{
    struct log_filter wanted = filter->wanted;
    struct log_entry *entry[LOGS] = {NULL};
    struct rows_subject of;
    size_t of_log[LOGS] = {0};
    enum status st = ST_OK;

    if (filter->subject != NULL) {
        if ((st = rows_subject_find(t, filter->subject, &of, e)) != ST_OK)
            return st;
        sodium_memzero(of.key, sizeof of.key);
        wanted.uid = of.one.uid;
    }
    for (int i = 0; i < LOGS && st == ST_OK; i++)
        if (filter->log == NULL || *filter->log == (enum log_name)i)
            st = log_list(t->sql, (enum log_name)i, &wanted, &entry[i], &of_log[i], e);
    *n = of_log[LOG_CHANGES] + of_log[LOG_ACCESSES];
    if (st == ST_OK && *n > 0 && (*out = calloc(*n, sizeof **out)) == NULL)
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
    if (st == ST_OK && *n > 0) {
        const size_t all = *n;

        *n = wanted.limit != 0 && wanted.limit < all ? (size_t)wanted.limit : all;
        merge(entry, of_log, wanted.newest ? all - *n : 0, *out);
    }
    for (int i = 0; i < LOGS; i++)
        free(entry[i]);
    for (size_t i = 0; st == ST_OK && filter->names && i < *n; i++)
        st = find_name(t, &(*out)[i], e);
    return st;
}

enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = check_filter(filter, e)) != ST_OK ||
        (st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = store_end(s, &t, list(&t, filter, out, n, e), e)) != ST_OK) {
        free(*out);
        *out = NULL;
        *n = 0;
    }
    return st;
}

enum status store_audit_public(struct store *s, unsigned char public[CRYPT_KEY],
                               struct errinfo *e)
{
    (void)e;
    crypt_public(s->crypt, public);
    return ST_OK;
}

enum status store_audit_has(struct store *s, const struct log_end *at, bool *has,
                            struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    *has = false;
    return st == ST_OK ? store_end(s, &t, log_has(&t, at, has, e), e) : st;
}

struct at_end { /* of the changes */
    struct log_walk *walk;
    uint64_t seq;
};

static void report_row(void *arg, const char *line)
{
    struct at_end *end = arg;

    end->walk->log = LOG_CHANGES;
    log_walk_problem(end->walk, end->seq, line);
}

enum status store_audit_verify(struct store *s, log_report *report, void *arg,
                               struct log_walk *out, struct errinfo *e)
{
    unsigned char public[CRYPT_KEY];
    struct at_end end = {.walk = out};
    struct errinfo why;
    struct log_txn t;
    enum status st;

    crypt_public(s->crypt, public);
    log_walk_begin(out, s->crypt, public, report, arg);
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK ||
        (st = store_end(s, &t, log_walk_all(t.sql, out, e), e)) != ST_OK)
        return st;
    end.seq = t.changes.seq;
    if ((st = store_verify(s, report_row, &end, &why)) == ST_EREFUSED)
        return ST_OK; /* reported */
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "%s", why.msg);
}

/* ---- writing */

static enum status add_access(struct log_txn *t, const struct log_act *by,
                              const char *kind, const char *subject, const char *object,
                              const char *outcome, struct errinfo *e)
{
    struct rows_subject of = {.revision = 0};
    bool known = false;

    if (subject[0] != '\0') {
        const enum status st = rows_subject_find(t, subject, &of, e);

        sodium_memzero(of.key, sizeof of.key);
        if (st != ST_OK && st != ST_ENOTFOUND)
            return st;
        known = st == ST_OK;
    }
    return log_access(t, by, kind, known ? of.one.uid : NULL, object, outcome, e);
}

enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *object, const char *outcome,
                        struct errinfo *e)
{
    struct log_act by;
    struct log_txn t;
    enum status st;

    if (!ident_printable(kind, 1, LOG_TEXT) || !ident_printable(object, 0, LOG_TEXT) ||
        !ident_printable(outcome, 0, LOG_TEXT))
        return errinfo_set(e, ST_EINVAL,
                           "an entry's texts are up to %d printable "
                           "characters",
                           LOG_TEXT);
    if (subject[0] != '\0' && (st = ident_subject(subject, e)) != ST_OK)
        return st;
    if ((st = store_act_begin(s, actor, SQL_LAZY, &by, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, add_access(&t, &by, kind, subject, object, outcome, e), e);
}

enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct log_entry *out, struct errinfo *e)
{
    struct log_entry *entry = NULL;
    struct log_filter last = {.limit = 1, .newest = true};
    struct log_act by;
    struct log_txn t;
    size_t n = 0;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_act_begin(s, actor, SQL_WRITE, &by, &t, e)) != ST_OK)
        return st;
    if ((st = log_change(&t, &by, kind, NULL, "", "", e)) == ST_OK &&
        (st = log_list(t.sql, LOG_CHANGES, &last, &entry, &n, e)) == ST_OK && n == 1)
        *out = entry[0];
    free(entry);
    return store_end(s, &t, st, e);
}

/* ---- how long accesses are kept */

#define BATCH 20000 /* entries: other writers wait for about 0.1 s */
#define DAY   INT64_C(86400000)

/* What the oldest access that is left follows: the last one that was cut off. */
static enum status find_first(struct log_txn *t, struct log_end *before,
                              struct errinfo *e)
{
    const struct log_filter newest = {.kind = LOG_TRIM, .newest = true, .limit = 1};
    struct log_entry *trim = NULL;
    size_t n;
    const enum status st = log_list(t->sql, LOG_CHANGES, &newest, &trim, &n, e);

    *before = (struct log_end){.seq = 0};
    if (n > 0)
        (void)log_trimmed(trim, before);
    free(trim);
    return st;
}

/* The accesses after *last that are from before `until` and not the last of all, at most a batch, as
 * they were written: else somebody could make them older.  *last: the last of them; n: how many.
 * Their times follow each other but where the clock was set. */
static enum status find_last(struct log_txn *t, const char *until, struct log_end *last,
                             uint64_t *n, struct errinfo *e)
{
    struct log_end at = *last;
    struct log_entry entry;
    struct sql_rows *r;
    enum status st = SQL_QUERY(t->sql, &r, e,
                               "SELECT " LOG_ROW_ACCESS " FROM access_log WHERE seq > $1 "
                               "AND seq < (SELECT max(seq) FROM access_log) "
                               "ORDER BY seq LIMIT $2",
                               sql_int((int64_t)last->seq), sql_int(BATCH));

    *n = 0;
    while (st == ST_OK && sql_next(r)) {
        if (!log_row_read(r, LOG_ACCESSES, &entry) ||
            !log_follows(t->crypt, &at, &entry)) {
            st = errinfo_set(e, ST_ECORRUPT,
                             "entry %" PRIu64 " of the access log is not as it was "
                             "written: nothing is cut off (surfacectl audit verify)",
                             at.seq + 1);
        } else if (strcmp(entry.at, until) >= 0) {
            break;
        } else {
            *last = at;
            ++*n;
        }
    }
    return sql_done(r, st, e);
}

static enum status cut_off(struct log_txn *t, const struct log_act *by,
                           const struct log_end *last, struct errinfo *e)
{
    char outcome[32], hash[2 * LOG_HASH + 1];
    const enum status st = SQL_RUN(t->sql, e, "DELETE FROM access_log WHERE seq <= $1",
                                   sql_int((int64_t)last->seq));

    (void)snprintf(outcome, sizeof outcome, "%" PRIu64, last->seq);
    (void)sodium_bin2hex(hash, sizeof hash, last->hash, LOG_HASH);
    return st == ST_OK ? log_change(t, by, LOG_TRIM, NULL, hash, outcome, e) : st;
}

enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e)
{
    struct log_end last = {.seq = 0};
    char until[UTC_TEXT];
    struct log_act by;
    struct log_txn t;
    uint64_t n;
    enum status st;

    *cut = 0;
    if (days < 1 || days > STORE_TRIM_MAX)
        return errinfo_set(e, ST_EINVAL, "accesses are kept for 1 to %d days",
                           STORE_TRIM_MAX);
    do {
        n = 0;
        if ((st = store_act_begin(s, actor, dry ? SQL_READ : SQL_WRITE, &by, &t, e)) !=
            ST_OK)
            return st;
        utc_print(by.ms > days * DAY ? by.ms - days * DAY : 0, until);
        if (*cut > 0 || (st = find_first(&t, &last, e)) == ST_OK)
            st = find_last(&t, until, &last, &n, e);
        if (st == ST_OK && n > 0 && !dry)
            st = cut_off(&t, &by, &last, e);
        if ((st = store_end(s, &t, st, e)) == ST_OK)
            *cut += n;
    } while (st == ST_OK && n == BATCH);
    return st;
}
