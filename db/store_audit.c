#include "store.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "log_row.h"
#include "rows_subject.h"
#include "rows_token.h"
#include "sql_read.h"
#include "store_txn.h"
#include "utc.h"

/* ---- lists */

#define KINDS 256 /* bytes of a list of them */

static enum status check_filter(const struct store_audit_filter *f, struct errinfo *e)
{
    const char *const time[] = {f->since, f->until};

    if (f->kind != NULL && !ident_printable(f->kind, 1, KINDS))
        return errinfo_set(e, ST_EINVAL, "kinds are 1 to %d printable characters", KINDS);
    if (f->actor != NULL && !ident_printable(f->actor, 1, LOG_TEXT))
        return errinfo_set(e, ST_EINVAL, "an actor is 1 to %d printable characters",
                           LOG_TEXT);
    for (int i = 0; i < 2; i++)
        if (time[i] != NULL && !ident_consists(time[i], "0123456789-T:.Z", 4, 24))
            return errinfo_set(e, ST_EINVAL,
                               "a time is like 2026-11-21 or 2026-11-21T14:30, not %.40s",
                               time[i]);
    return f->subject != NULL ? ident_subject(f->subject, e) : ST_OK;
}

/* Who it is about, and who did it; a damaged row has no name here. */
static enum status find_names(struct log_txn *t, struct store_audit_entry *a,
                              struct errinfo *e)
{
    struct rows_token token;
    struct rows_subject of;
    enum status st = ST_OK;

    if (!sodium_is_zero(a->entry.uid, sizeof a->entry.uid)) {
        if ((st = rows_subject_get(t, a->entry.uid, &of, e)) == ST_OK)
            memcpy(a->subject, of.one.id, sizeof a->subject);
        a->erased = st == ST_ENOTFOUND;
        sodium_memzero(&of, sizeof of);
    }
    if ((st == ST_OK || st == ST_ENOTFOUND || st == ST_ECORRUPT) &&
        ident_id_valid(a->entry.actor)) {
        if ((st = rows_token_get(t, a->entry.actor, &token, e)) == ST_OK)
            memcpy(a->actor_name, token.token.name, sizeof a->actor_name);
        sodium_memzero(&token, sizeof token);
    }
    return st == ST_ENOTFOUND || st == ST_ECORRUPT ? ST_OK : st;
}

struct listing {
    struct log_txn *t;
    const struct store_audit_filter *filter;
    unsigned char uid[LOG_UID];
    struct sql_rows *rows[LOGS];
    struct log_entry at[LOGS]; /* the next one of each, */
    bool there[LOGS];          /* if there is one */
    struct store_audit_entry *out;
    size_t n, room;
    struct store_audit_place next;
};

/* Is the kind one of a list with commas? */
static bool listed(const char *list, const char *kind)
{
    const size_t n = strlen(kind);

    for (; *list != '\0'; list += strcspn(list, ","), list += *list == ',')
        if (strcspn(list, ",") == n && memcmp(list, kind, n) == 0)
            return true;
    return false;
}

static bool is_wanted(const struct listing *l, const struct log_entry *entry)
{
    const struct store_audit_filter *f = l->filter;

    return (sodium_is_zero(l->uid, LOG_UID) ||
            memcmp(l->uid, entry->uid, LOG_UID) == 0) &&
           (f->kind == NULL || listed(f->kind, entry->kind)) &&
           (f->actor == NULL || strcmp(f->actor, entry->actor) == 0) &&
           (f->since == NULL || strncmp(entry->at, f->since, strlen(f->since)) >= 0) &&
           (f->until == NULL || strncmp(entry->at, f->until, strlen(f->until)) <= 0);
}

static enum status advance(struct listing *l, enum log_name log, struct errinfo *e)
{
    return l->rows[log] == NULL
               ? ST_OK
               : log_rows_next(l->rows[log], log, &l->at[log], &l->there[log], e);
}

static enum status begin(struct listing *l, enum log_name log, struct errinfo *e)
{
    const struct store_audit_filter *f = l->filter;
    enum status st;

    l->next.seq[log] = f->from.seq[log];
    if (f->log != NULL && *f->log != log)
        return ST_OK;
    if ((st = log_rows(l->t->sql, log, f->newest, f->from.seq[log], &l->rows[log], e)) ==
        ST_OK)
        st = advance(l, log, e);
    if (f->newest && f->from.seq[log] == 0) /* before all, or of an empty log */
        l->next.seq[log] = l->there[log] ? l->at[log].seq + 1 : 1;
    return st;
}

/* The log whose entry is the next of both: a change says how many accesses came before it. */
static enum log_name choose(const struct listing *l)
{
    const bool access_first = l->at[LOG_ACCESSES].seq <= l->at[LOG_CHANGES].accesses.seq;

    if (!l->there[LOG_CHANGES] || !l->there[LOG_ACCESSES])
        return l->there[LOG_CHANGES] ? LOG_CHANGES : LOG_ACCESSES;
    return access_first != l->filter->newest ? LOG_ACCESSES : LOG_CHANGES;
}

static enum status keep(struct listing *l, const struct log_entry *entry,
                        struct errinfo *e)
{
    if (l->n == l->room) {
        const size_t room = 2 * l->room + 64;
        struct store_audit_entry *more = realloc(l->out, room * sizeof *more);

        if (more == NULL)
            return errinfo_set(e, ST_ENOMEM, "out of memory");
        l->out = more;
        l->room = room;
    }
    l->out[l->n++] = (struct store_audit_entry){.entry = *entry};
    return ST_OK;
}

/* Until there is one more than wanted, or all that may be were looked at. */
static enum status list(struct listing *l, struct errinfo *e)
{
    const struct store_audit_filter *f = l->filter;
    enum status st = ST_OK;

    for (uint64_t looked = 0; l->there[LOG_CHANGES] || l->there[LOG_ACCESSES]; looked++) {
        const enum log_name log = choose(l);
        const struct log_entry *entry = &l->at[log];
        const bool wanted = is_wanted(l, entry);

        if ((f->most != 0 && looked == f->most) ||
            (wanted && f->limit != 0 && l->n == f->limit))
            return ST_OK;
        if (wanted && (st = keep(l, entry, e)) != ST_OK)
            return st;
        l->next.seq[log] = entry->seq;
        if ((st = advance(l, log, e)) != ST_OK)
            return st;
    }
    l->next.end = true;
    return ST_OK;
}

static enum status find_uid(struct listing *l, struct errinfo *e)
{
    struct rows_subject of;
    enum status st;

    if (l->filter->uid != NULL)
        memcpy(l->uid, l->filter->uid, LOG_UID);
    if (l->filter->subject == NULL)
        return ST_OK;
    if ((st = rows_subject_find(l->t, l->filter->subject, &of, e)) == ST_OK)
        memcpy(l->uid, of.one.uid, LOG_UID);
    sodium_memzero(&of, sizeof of);
    return st;
}

static enum status list_all(struct listing *l, struct errinfo *e)
{
    enum status st = find_uid(l, e);

    for (int i = 0; i < LOGS && st == ST_OK; i++)
        st = begin(l, (enum log_name)i, e);
    if (st == ST_OK)
        st = list(l, e);
    for (int i = 0; i < LOGS; i++)
        if (l->rows[i] != NULL)
            st = sql_done(l->rows[i], st, e);
    for (size_t i = 0; st == ST_OK && l->filter->names && i < l->n; i++)
        st = find_names(l->t, &l->out[i], e);
    return st;
}

enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct store_audit_place *next, struct errinfo *e)
{
    struct log_txn t;
    struct listing l = {.t = &t, .filter = filter};
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = check_filter(filter, e)) != ST_OK ||
        (st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = store_end(s, &t, list_all(&l, e), e)) != ST_OK) {
        free(l.out);
        return st;
    }
    *out = l.out;
    *n = l.n;
    if (next != NULL)
        *next = l.next;
    return ST_OK;
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
    struct sql_rows *r = NULL;
    struct log_act by;
    struct log_txn t;
    bool there;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_act_begin(s, actor, SQL_WRITE, &by, &t, e)) != ST_OK)
        return st;
    if ((st = log_change(&t, &by, kind, NULL, "", "", e)) == ST_OK &&
        (st = log_rows(t.sql, LOG_CHANGES, true, 0, &r, e)) == ST_OK)
        st = sql_done(r, log_rows_next(r, LOG_CHANGES, out, &there, e), e);
    return store_end(s, &t, st, e);
}

/* ---- how long accesses are kept */

#define BATCH 20000 /* entries: other writers wait for about 0.1 s */
#define DAY   INT64_C(86400000)

/* What the oldest access that is left follows: the last one that was cut off. */
static enum status find_first(struct log_txn *t, struct log_end *before,
                              struct errinfo *e)
{
    struct log_entry *trim = NULL;
    size_t n;
    const enum status st = log_list(t->sql, LOG_TRIM, 0, &trim, &n, e);

    *before = (struct log_end){.seq = 0};
    if (n > 0)
        (void)log_trimmed(&trim[n - 1], before);
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
