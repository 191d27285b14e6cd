#include "store.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "log_anchor.h"
#include "log_row.h"
#include "rows_scan.h"
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

/* Finds the names of the subject and of the actor.  A damaged row gives no name. */
static enum status find_names(struct log_txn *t, struct store_audit_entry *a,
                              struct errinfo *e)
{
    struct rows_token token;
    struct rows_subject of;
    enum status st = ST_OK;

    if (!sodium_is_zero(a->entry.uid, sizeof a->entry.uid)) {
        if ((st = rows_subject_get(t, a->entry.uid, &of, e)) == ST_OK) {
            memcpy(a->subject, of.one.id, sizeof a->subject);
            memcpy(a->groups, of.one.groups, sizeof a->groups);
        }
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

#define PAGE 250 /* entries of a stream that are in memory */

struct stream {             /* the changes, or a daemon's accesses */
    struct log_place place; /* of what comes behind the page */
    struct log_entry *page; /* [n] */
    size_t n;
    const struct log_entry *at; /* the next one, NULL: there is none */
    uint64_t *next;             /* the place behind which it lies */
    uint32_t *mark;
};

struct store_audit_listing {
    struct log_txn *t;
    const struct store_audit_filter *filter;
    unsigned char uid[LOG_UID];
    struct stream *stream; /* [n] */
    uint32_t nstreams;
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

static bool is_wanted(const struct store_audit_listing *l, const struct log_entry *entry)
{
    const struct store_audit_filter *f = l->filter;

    return (sodium_is_zero(l->uid, LOG_UID) ||
            memcmp(l->uid, entry->uid, LOG_UID) == 0) &&
           (f->kind == NULL || listed(f->kind, entry->kind)) &&
           (f->actor == NULL || strcmp(f->actor, entry->actor) == 0) &&
           (f->since == NULL || strncmp(entry->at, f->since, strlen(f->since)) >= 0) &&
           (f->until == NULL || strncmp(entry->at, f->until, strlen(f->until)) <= 0);
}

static enum status advance(struct store_audit_listing *l, struct stream *x,
                           struct errinfo *e)
{
    enum status st = ST_OK;

    if (x->at != NULL && x->at + 1 < x->page + x->n) {
        x->at++;
        return ST_OK;
    }
    free(x->page);
    x->page = NULL;
    st = log_page(l->t->sql, &x->place, PAGE, &x->page, &x->n, e);
    x->at = x->n > 0 ? x->page : NULL;
    if (x->n > 0)
        x->place.seq = x->page[x->n - 1].seq;
    return st;
}

static enum status store_audit_begin(struct store_audit_listing *l, struct stream *x,
                                     struct errinfo *e)
{
    const struct store_audit_filter *f = l->filter;
    const enum log_name log = x->place.log;
    const uint32_t daemon = x->place.daemon;
    enum status st = ST_OK;

    x->place.newest = f->newest;
    x->place.seq = log == LOG_CHANGES ? f->from.changes : f->from.accesses[daemon];
    if (f->newest && f->from.daemons > 0 && daemon >= f->from.daemons)
        x->place.seq = 1; /* it has joined since: all that it wrote is newer */
    *x->next = x->place.seq;
    *x->mark = log == LOG_CHANGES ? f->from.change_mark : f->from.access_mark[daemon];
    if ((f->log != NULL && *f->log != log) ||
        (f->daemon != NULL && (log != LOG_ACCESSES || *f->daemon != daemon)))
        return ST_OK;
    if ((st = advance(l, x, e)) == ST_OK && f->newest && *x->next == 0)
        *x->next =
            x->at != NULL ? x->at->seq + 1 : 1; /* before all, or of an empty log */
    return st;
}

/* A change says how many accesses of a daemon came before it; else clocks decide. */
static bool is_before(const struct log_entry *a, const struct log_entry *b)
{
    if (a->log != b->log && a->daemon == b->daemon)
        return a->log == LOG_CHANGES ? a->accesses.seq < b->seq
                                     : a->seq <= b->accesses.seq;
    return strcmp(a->at, b->at) < 0;
}

/* The one whose entry is the next of all; NULL: there are no more. */
static struct stream *store_audit_choose(const struct store_audit_listing *l)
{
    struct stream *best = NULL;

    for (uint32_t i = 0; i < l->nstreams; i++) {
        struct stream *x = &l->stream[i];

        if (x->at != NULL &&
            (best == NULL || is_before(x->at, best->at) != l->filter->newest))
            best = x;
    }
    return best;
}

static enum status store_audit_keep(struct store_audit_listing *l,
                                    const struct log_entry *entry, struct errinfo *e)
{
    if (l->n == l->room) {
        const size_t room = 2 * l->room + 64;
        struct store_audit_entry *more = realloc(l->out, room * sizeof *more);

        if (more == NULL)
            return errinfo_memory(e);
        l->out = more;
        l->room = room;
    }
    l->out[l->n++] = (struct store_audit_entry){.entry = *entry};
    return ST_OK;
}

/* Until there is one more than wanted, or all that may be were looked at. */
static enum status store_audit_list_log(struct store_audit_listing *l, struct errinfo *e)
{
    const struct store_audit_filter *f = l->filter;
    struct stream *x;
    enum status st = ST_OK;

    for (uint64_t looked = 0; (x = store_audit_choose(l)) != NULL; looked++) {
        const bool wanted = is_wanted(l, x->at);

        if ((f->most != 0 && looked == f->most) ||
            (wanted && f->limit != 0 && l->n == f->limit))
            return ST_OK;
        if (wanted && (st = store_audit_keep(l, x->at, e)) != ST_OK)
            return st;
        *x->next = x->at->seq;
        *x->mark = store_audit_mark(x->at);
        if ((st = advance(l, x, e)) != ST_OK)
            return st;
    }
    l->next.end = true;
    return ST_OK;
}

static enum status find_uid(struct store_audit_listing *l, struct errinfo *e)
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

static enum status open_streams(struct store_audit_listing *l, struct errinfo *e)
{
    uint32_t n;
    enum status st = log_daemons(l->t->sql, &n, e);

    if (st != ST_OK)
        return st;
    if (n < l->filter->from.daemons) /* all of one's were cut off since */
        n = l->filter->from.daemons;
    if ((l->stream = calloc(1 + n, sizeof *l->stream)) == NULL)
        return errinfo_memory(e);
    l->nstreams = 1 + n;
    l->next.daemons = n;
    l->stream[0].next = &l->next.changes;
    l->stream[0].mark = &l->next.change_mark;
    for (uint32_t i = 0; i < n; i++)
        l->stream[1 + i] = (struct stream){.place = {.log = LOG_ACCESSES, .daemon = i},
                                           .next = &l->next.accesses[i],
                                           .mark = &l->next.access_mark[i]};
    for (uint32_t i = 0; i < l->nstreams && st == ST_OK; i++)
        st = store_audit_begin(l, &l->stream[i], e);
    return st;
}

static enum status list_all(struct store_audit_listing *l, struct errinfo *e)
{
    enum status st;

    if ((st = find_uid(l, e)) == ST_OK && (st = open_streams(l, e)) == ST_OK)
        st = store_audit_list_log(l, e);
    for (uint32_t i = 0; i < l->nstreams; i++)
        free(l->stream[i].page);
    free(l->stream);
    for (size_t i = 0; st == ST_OK && l->filter->names && i < l->n; i++)
        st = find_names(l->t, &l->out[i], e);
    return st;
}

enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct store_audit_place *next, struct errinfo *e)
{
    struct log_txn t;
    struct store_audit_listing l = {.t = &t, .filter = filter};
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

void store_audit_public(const struct store *s, char hex[2 * CRYPT_KEY + 1])
{
    unsigned char public[CRYPT_KEY];

    crypt_public(s->crypt, public);
    (void)sodium_bin2hex(hex, 2 * CRYPT_KEY + 1, public, sizeof public);
}

enum status store_audit_has(struct store *s, const struct log_end *at, bool *has,
                            struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    *has = false;
    return st == ST_OK ? store_end(s, &t, log_has(&t, at, has, e), e) : st;
}

enum status store_audit_anchor(struct store *s, const char *path, uint32_t *daemon,
                               struct log_end *at, bool *has, struct errinfo *e)
{
    struct log_anchor said;
    const enum status st = log_anchor_read(path, s->crypt, &said, e);

    *has = false;
    *daemon = said.daemon;
    *at = said.end;
    return st == ST_OK ? store_audit_has(s, at, has, e) : st;
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
    st = store_verify(s, report_row, &end, &why);
    return st == ST_OK || !store_txn_may_pass(st) /* reported */
               ? ST_OK
               : errinfo_set(e, st, "%s", why.msg);
}

/* ---- writing */

static enum status add_access(struct log_txn *t, const char *kind, const char *subject,
                              const char *object, const char *outcome, struct errinfo *e)
{
    struct rows_subject of = {.revision = 0};
    bool known = false;

    if (subject[0] != '\0') {
        enum status st = store_actor_may(t, e); /* of other groups there is none */

        if (st == ST_OK)
            st = rows_subject_find(t, subject, &of, e);
        else if (st == ST_ETOKEN)
            st = ST_ENOTFOUND; /* it was revoked meanwhile */

        sodium_memzero(of.key, sizeof of.key);
        if (st != ST_OK && st != ST_ENOTFOUND)
            return st;
        known = st == ST_OK;
    }
    return log_access(t, kind, known ? of.one.uid : NULL, object, outcome, e);
}

static enum status add_event(struct store *s, const char *kind, const char *actor,
                             const char *subject, const char *object, const char *outcome,
                             const struct store_scan *scan, struct errinfo *e)
{
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
    st = store_begin_use(s, actor, SQL_LAZY, &(struct store_use){.appends = true}, &t, e);
    if (st != ST_OK)
        return st;
    if (scan != NULL)
        st = rows_scan_count(&t, scan, e);
    if (st == ST_OK)
        st = add_access(&t, kind, subject, object, outcome, e);
    return store_end(s, &t, st, e);
}

enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *object, const char *outcome,
                        struct errinfo *e)
{
    return add_event(s, kind, actor, subject, object, outcome, NULL, e);
}

enum status store_event_scan(struct store *s, const char *kind, const char *actor,
                             const char *subject, const char *outcome,
                             const struct store_scan *scan, struct errinfo *e)
{
    return add_event(s, kind, actor, subject, "", outcome, scan, e);
}

static enum status sign(struct log_txn *t, const char *kind, struct log_entry *out,
                        struct store_audit_place *to, struct errinfo *e)
{
    const struct log_place last = {.log = LOG_CHANGES, .newest = true};
    struct log_entry *made = NULL;
    size_t n = 0;
    enum status st = log_daemons(t->sql, &to->daemons, e);

    for (uint32_t i = 0; i < to->daemons && st == ST_OK; i++)
        st = log_found(t, i, &to->accesses[i], e);
    if (st != ST_OK || (st = log_change(t, kind, NULL, "", "", e)) != ST_OK ||
        (st = log_page(t->sql, &last, 1, &made, &n, e)) != ST_OK)
        return st;
    *out = made[0];
    to->changes = out->seq;
    to->accesses[out->daemon] = out->accesses.seq;
    free(made);
    return ST_OK;
}

enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct log_entry *out, struct store_audit_place *to,
                             struct errinfo *e)
{
    struct store_audit_place end = {.changes = 0};
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_act_begin(s, actor, SQL_WRITE, &t, e)) == ST_OK)
        st = store_end(s, &t, sign(&t, kind, out, &end, e), e);
    if (to != NULL)
        *to = end;
    return st;
}

/* ---- how long accesses are kept */

#define BATCH 20000 /* entries: other writers wait for about 0.1 s */
#define DAY   INT64_C(86400000)

/* What the oldest access that is left follows: the last one that was cut off, of each daemon. */
static enum status find_first(struct log_txn *t, struct log_end before[LOG_DAEMONS],
                              struct errinfo *e)
{
    struct log_entry *trim = NULL;
    size_t n;
    const enum status st = log_list(t->sql, LOG_TRIM, 0, &trim, &n, e);

    for (size_t i = 0; i < n; i++)
        (void)log_trimmed(&trim[i], before);
    free(trim);
    return st;
}

/* The daemon's accesses after *last that are from before `until` and not its last, at most a batch, as
 * they were written: an attacker could make them older.  *last: the last of them; n: their number.
 * Their times ascend, unless the clock was set. */
static enum status find_last(struct log_txn *t, uint32_t daemon, const char *until,
                             struct log_end *last, uint64_t *n, struct errinfo *e)
{
    struct log_end at = *last;
    struct log_entry entry;
    struct sql_rows *r;
    enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT " LOG_ROW_ACCESS " FROM access_log WHERE daemon = $1 AND seq > $2 "
        "AND seq < (SELECT max(seq) FROM access_log WHERE daemon = $1) "
        "ORDER BY seq LIMIT $3",
        sql_int(daemon), sql_int((int64_t)last->seq), sql_int(BATCH));

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

static enum status cut_off(struct log_txn *t, uint32_t daemon, const struct log_end *last,
                           struct errinfo *e)
{
    char outcome[LOG_TEXT + 1], hash[2 * LOG_HASH + 1];
    const enum status st =
        SQL_RUN(t->sql, e, "DELETE FROM access_log WHERE daemon = $1 AND seq <= $2",
                sql_int(daemon), sql_int((int64_t)last->seq));

    log_trim_text(daemon, last->seq, outcome);
    (void)sodium_bin2hex(hash, sizeof hash, last->hash, LOG_HASH);
    return st == ST_OK ? log_change(t, LOG_TRIM, NULL, hash, outcome, e) : st;
}

struct trimming { /* of one daemon's */
    struct store *store;
    const char *actor;
    unsigned days;
    bool dry;
    uint32_t daemon;
    struct log_end last; /* that was cut off */
};

static enum status trim_batch(struct trimming *x, uint64_t *n, struct errinfo *e)
{
    struct log_end first[LOG_DAEMONS] = {{.seq = 0}};
    char until[UTC_TEXT];
    struct log_txn t;
    enum status st;

    *n = 0;
    if ((st = store_act_begin(x->store, x->actor, x->dry ? SQL_READ : SQL_WRITE, &t,
                              e)) != ST_OK)
        return st;
    utc_print(t.by.ms > x->days * DAY ? t.by.ms - x->days * DAY : 0, until);
    if (x->last.seq == 0 && (st = find_first(&t, first, e)) == ST_OK)
        x->last = first[x->daemon];
    if (st == ST_OK)
        st = find_last(&t, x->daemon, until, &x->last, n, e);
    if (st == ST_OK && *n > 0 && !x->dry)
        st = cut_off(&t, x->daemon, &x->last, e);
    return store_end(x->store, &t, st, e);
}

static enum status count_daemons(struct store *s, uint32_t *n, struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    return st == ST_OK ? store_end(s, &t, log_daemons(t.sql, n, e), e) : st;
}

enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e)
{
    uint32_t daemons = 0;
    uint64_t n;
    enum status st;

    *cut = 0;
    if (days < 1 || days > STORE_TRIM_MAX)
        return errinfo_set(e, ST_EINVAL, "accesses are kept for 1 to %d days",
                           STORE_TRIM_MAX);
    st = count_daemons(s, &daemons, e);
    for (uint32_t i = 0; i < daemons && st == ST_OK; i++) {
        struct trimming x = {
            .store = s, .actor = actor, .days = days, .dry = dry, .daemon = i};

        do {
            if ((st = trim_batch(&x, &n, e)) == ST_OK)
                *cut += n;
        } while (st == ST_OK && n == BATCH);
    }
    return st;
}
