#include "store_verification.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>

#include "rows_attempts.h"
#include "rows_calibration.h"
#include "rows_day.h"
#include "rows_scan.h"
#include "rows_template.h"
#include "store_people.h"
#include "store_template.h"
#include "store_txn.h"

/* ---- what it reads */

struct store_reading {
    struct store *store;
    const struct store_snapshot_of *what; /* until store_snapshot_begin() returns */
    struct log_txn own, *t;
    struct rows_subject of;
    struct rows_template *row; /* [n] of the snapshot */
    /* The heads of all faces, by rows_template_heads(); none before the first is needed. */
    unsigned char *head[STORE_TEMPLATES_MAX];
    size_t len[STORE_TEMPLATES_MAX];
    bool read;
    bool begun, future;
    bool one;    /* a template was asked for, and not a subject */
    bool within; /* the transaction is another one's */
};

/* Reads the subject with all its templates, and the attempts. */
static enum status read_subject(struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;
    enum status st = rows_subject_find(r->t, r->what->subject, &r->of, e);

    if (sql_goes_on(r->t->sql, st))
        st = rows_template_list(r->t, &r->of, &r->row, &out->n, e);
    if (sql_goes_on(r->t->sql, st))
        st = rows_attempts_find(r->t, &r->of, r->t->by.actor, r->t->by.ms, &out->attempts,
                                &r->future, e);
    return st;
}

/* Reads one template with its subject, and the attempts. */
static enum status read_template(struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;
    enum status st;

    if (r->row == NULL && (r->row = malloc(sizeof *r->row)) == NULL)
        return errinfo_memory(e);
    out->n = 1;
    if ((st = rows_template_get(r->t, r->what->template_id, r->row, &r->of, e)) != ST_OK)
        return st;
    return rows_attempts_find(r->t, &r->of, r->t->by.actor, r->t->by.ms, &out->attempts,
                              &r->future, e);
}

/* Reads a subject within a search. */
static enum status read_found(struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;
    const enum status st = rows_subject_get(r->t, r->what->uid, &r->of, e);

    return st == ST_OK ? rows_template_list(r->t, &r->of, &r->row, &out->n, e) : st;
}

static enum status read_all(void *arg, struct errinfo *e)
{
    struct store_snapshot *out = arg;
    struct store_reading *r = out->reading;
    struct store_calibration k;
    enum status st = store_actor_may(r->t, e);

    if (sql_goes_on(r->t->sql, st))
        st = r->what->subject != NULL ? read_subject(out, e) : read_template(out, e);
    if (!sql_goes_on(r->t->sql, st))
        return st;
    if ((st = rows_calibration_get(r->t, &k, e)) != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st;
    out->calibration = k.version;
    if (k.version != r->what->calibration)
        out->k = k;
    return ST_OK;
}

/* What is read, and the heads of the faces, which follow if the subject is admitted. */
static enum status read_with_heads(void *arg, struct errinfo *e)
{
    struct store_reading *r = ((struct store_snapshot *)arg)->reading;
    const enum status st = read_all(arg, e);

    if (!r->one && sql_goes_on(r->t->sql, st))
        return rows_template_heads(r->t, &r->of, NULL, 0, true, NULL, NULL, e);
    return st;
}

/* Describes the rows to the caller. */
static enum status describe(struct store_snapshot *out, struct errinfo *e)
{
    const struct store_reading *r = out->reading;

    if (out->n > STORE_TEMPLATES_MAX)
        return errinfo_set(e, ST_ECORRUPT, "subject %s has %zu templates, more than %d",
                           r->of.one.id, out->n, STORE_TEMPLATES_MAX);
    if ((out->t = malloc((out->n + 1) * sizeof *out->t)) == NULL)
        return errinfo_memory(e);
    for (size_t i = 0; i < out->n; i++)
        out->t[i] = r->row[i].one;
    out->subject = r->of.one;
    store_rules_shown(r->t, &out->subject);
    out->subject.expired = store_rules_past(out->subject.expires, r->t->by.ms);
    return ST_OK;
}

static enum status store_snapshot_start(struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;
    enum status st = store_start(r->store, r->what->token, SQL_READ, NULL, r->t, e);

    if (st != ST_OK)
        return st;
    store_read_ahead(r->t, read_with_heads, out);
    if ((st = store_check(r->store, r->t, e)) != ST_OK)
        return st;
    r->begun = true;
    return read_all(out, e);
}

enum status store_snapshot_begin(struct store *s, const struct store_snapshot_of *what,
                                 struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r;
    enum status st;

    *out = (struct store_snapshot){.n = 0};
    st = what->subject != NULL       ? ident_subject(what->subject, e)
         : what->template_id != NULL ? ident_id(what->template_id, "template", e)
                                     : ST_OK;
    if (st != ST_OK)
        return st;
    if ((r = out->reading = calloc(1, sizeof *r)) == NULL)
        return errinfo_memory(e);
    r->store = s;
    r->what = what;
    r->one = what->template_id != NULL;
    r->within = what->uid != NULL;
    r->t = r->within ? store_people_txn(what->people) : &r->own;
    st = r->within ? read_found(out, e) : store_snapshot_start(out, e);
    return st == ST_OK ? describe(out, e) : st;
}

/* The heads of all templates, by one query; the whole face if there is one. */
static enum status need_heads(const struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;

    if (r->read)
        return ST_OK;
    r->read = true;
    return r->one ? rows_template_face(r->t, r->row, &r->of, r->head, r->len, e)
                  : rows_template_heads(r->t, &r->of, r->row, out->n, !r->within, r->head,
                                        r->len, e);
}

enum status store_snapshot_face(const struct store_snapshot *out, size_t i,
                                struct surface_work *w, struct surface_face **f,
                                struct errinfo *e)
{
    struct store_reading *r = out->reading;
    unsigned char *face = NULL;
    size_t len = 0;
    enum status st;

    if (!store_template_outdated(r->store, &out->t[i])) {
        st = need_heads(out, e);
        return st != ST_OK ? st
                           : store_template_decode(r->store, &out->t[i], r->head[i],
                                                   r->len[i], w, f, e);
    }
    st = rows_template_face(r->t, &r->row[i], &r->of, &face, &len, e);
    if (st == ST_OK)
        st = store_template_decode(r->store, &out->t[i], face, len, w, f, e);
    rows_template_wipe(face, len);
    return st;
}

static enum status move_future(const struct store_reading *r, struct errinfo *e)
{
    const struct store_use use = {.subject = r->of.one.key, .token = r->t->by.actor};
    struct log_txn t;
    const enum status st = store_begin_use(r->store, use.token, SQL_LAZY, &use, &t, e);

    if (st != ST_OK)
        return st;
    return store_end(r->store, &t,
                     rows_attempts_not_after(&t, &r->of.one, use.token, t.by.ms, e), e);
}

enum status store_snapshot_end(struct store_snapshot *out, enum status st,
                               struct errinfo *e)
{
    struct store_reading *r = out->reading;
    struct errinfo why = {0};
    enum status moved;

    if (r == NULL)
        return st;
    if (r->begun)
        st = store_end(r->store, r->t, st, e);
    /* also if the reading was refused: a lock-out must end */
    if (r->future && (moved = move_future(r, &why)) != ST_OK && st == ST_OK)
        st = errinfo_set(e, moved, "%s", why.msg);
    for (size_t i = 0; i < out->n && i < STORE_TEMPLATES_MAX; i++)
        rows_template_wipe(r->head[i], r->len[i]);
    free(r->row);
    sodium_memzero(r, sizeof *r);
    free(r);
    out->reading = NULL;
    return st;
}

void store_snapshot_free(struct store_snapshot *out)
{
    free(out->t);
    *out = (struct store_snapshot){.n = 0};
}

/* ---- what it writes */

/* A record that is being written. */
struct recording {
    struct log_txn t;
    struct store_record what;
    char
        same[STORE_ID_LEN + 1]; /* template made of one of the probe's frames; "": none */
    struct store_day day;
    bool future;
    struct store_recorded *out;
};

static enum status find_same(struct recording *r, struct errinfo *e)
{
    const struct store_probe *p = r->what.probe;
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && r->same[0] == '\0' && p->read[i] != NULL; i++)
        st = rows_template_same(&r->t, r->what.subject->uid, p->used, p->read[i], r->same,
                                e);
    return st;
}

static enum status read_before(void *arg, struct errinfo *e)
{
    struct recording *r = arg;
    const struct store_record *what = &r->what;
    enum status st = store_actor_may(&r->t, e);

    if (sql_goes_on(r->t.sql, st))
        st = rows_attempts_get(&r->t, what->subject, what->actor, r->t.by.ms,
                               &r->out->now, &r->future, e);
    if (sql_goes_on(r->t.sql, st) && what->probe != NULL)
        st = find_same(r, e);
    if (sql_goes_on(r->t.sql, st) && what->decision != NULL)
        st = rows_day_get(&r->t, r->t.by.at, what->decision, &r->day, e);
    return st;
}

/* A match by a scan that is no new one is no match. */
static void look_back(struct recording *r)
{
    if (r->what.probe == NULL || (r->same[0] == '\0' && !r->what.replayed))
        return;
    r->out->replayed = true;
    r->what.outcome = "replayed";
    if (r->what.as == STORE_RECORD_PASSED)
        r->what.as = STORE_RECORD_FAILED;
}

/* Returns the warnings of an attempt after was: a bit of enum store_warning each. */
static unsigned judge(const struct store_record *what, const struct store_attempts *was)
{
    const struct store_limits *l = what->limits;
    const uint32_t before =
        was->tried_warn + (was->failures > 0 && was->age_ms < STORE_FAILED_MS);
    const uint32_t after = was->tried_warn + 1;
    unsigned warnings = 0, third;

    if (what->as != STORE_RECORD_FAILED || l == NULL || l->failures == 0)
        return 0;
    third = what->actor[0] == '\0' ? 0 : (l->subjects + 2) / 3;
    if ((uint64_t)was->failures + was->others + 1 >= l->failures)
        warnings |= 1U << STORE_LOCKED_OUT;
    if (third > 0 && after > before && after / third > before / third)
        warnings |= 1U << STORE_MANY_SUBJECTS;
    if ((uint64_t)store_attempts_suspicion(was, true) + was->others_suspicion >=
        STORE_SUSPICION)
        warnings |= 1U << STORE_ATTEMPTS_PATTERN;
    return warnings;
}

enum status store_record_attempt(struct log_txn *t, const struct store_record *what,
                                 int64_t now, struct store_recorded *out,
                                 struct errinfo *e)
{
    const struct store_attempts *was = &out->now;
    const bool failed = what->as == STORE_RECORD_FAILED;
    const uint32_t suspicion = store_attempts_suspicion(was, failed);
    enum status st = ST_OK;

    out->warnings = judge(what, was);
    if (failed)
        st = rows_attempts_fail(t, what->subject, what->actor, now, suspicion, e);
    else if (what->as == STORE_RECORD_PASSED && (was->failures > 0 || was->suspicion > 0))
        st = rows_attempts_match(t, what->subject, what->actor, suspicion, e);
    /* One or the other: all rows of a subject, and old rows of a token on any subject.  Two transactions
     * that changed both could wait for each other on a server. */
    if (st == ST_OK && (out->warnings & 1U << STORE_ATTEMPTS_PATTERN) != 0)
        st = rows_attempts_told(t, what->subject, e);
    else if (st == ST_OK && failed)
        st = rows_attempts_expire(t, what->actor, now, e);
    return st;
}

/* "3 failures until 2026-11-30T01:24:54.000Z" */
static void print_lockout(const struct store_record *what, int64_t now_ms,
                          const struct store_attempts *was, char out[LOG_TEXT + 1])
{
    struct store_attempts now = *was;
    char until[UTC_TEXT];
    enum store_wait why;

    now.failures++;
    now.age_ms = 0;
    utc_print(now_ms + store_attempts_wait_ms(what->limits, &now, &why), until);
    (void)snprintf(out, LOG_TEXT + 1, "%" PRIu64 " failures until %s",
                   (uint64_t)now.failures + now.others, until);
}

static enum status add_events(struct log_txn *t, const struct store_record *what,
                              const struct store_recorded *out, struct errinfo *e)
{
    static const char *const kind[STORE_WARNINGS] = {"locked_out", "many_subjects",
                                                     "attempts_pattern"};
    const unsigned char *uid = what->subject->uid;
    char outcome[STORE_WARNINGS][LOG_TEXT + 1];
    enum status st = log_access(t, what->kind, uid, what->template_id, what->outcome, e);

    print_lockout(what, t->by.ms, &out->now, outcome[STORE_LOCKED_OUT]);
    (void)snprintf(outcome[STORE_MANY_SUBJECTS], sizeof outcome[0],
                   "%" PRIu32 " subjects", out->now.tried_warn + 1);
    (void)snprintf(outcome[STORE_ATTEMPTS_PATTERN], sizeof outcome[0],
                   "failures between matches");
    for (unsigned i = 0; st == ST_OK && i < STORE_WARNINGS; i++)
        if ((out->warnings & 1U << i) != 0)
            st = log_access(t, kind[i], uid, "", outcome[i], e);
    return st;
}

static enum status write_all(struct recording *r, struct errinfo *e)
{
    struct store_recorded *out = r->out;
    enum status st;

    out->wait_ms = store_attempts_wait_ms(r->what.limits, &out->now, &out->why);
    if (out->why != STORE_WAIT_NONE)
        return ST_OK;
    look_back(r);
    if ((r->what.decision != NULL && !out->replayed &&
         (st = rows_day_count(&r->t, &r->day, r->what.score, e)) != ST_OK) ||
        (r->what.scan != NULL && !out->replayed &&
         (st = rows_scan_count(&r->t, r->what.scan, e)) != ST_OK) ||
        (st = store_record_attempt(&r->t, &r->what, r->t.by.ms, out, e)) != ST_OK ||
        (st = add_events(&r->t, &r->what, out, e)) != ST_OK ||
        store_rules_recent(r->what.subject->seen, r->t.by.ms))
        return st;
    return rows_subject_seen(&r->t, r->what.subject->uid, r->t.by.at, e);
}

enum status store_record_verification(struct store *s, const struct store_record *what,
                                      struct store_recorded *out, struct errinfo *e)
{
    const bool failed = what->as == STORE_RECORD_FAILED;
    const struct store_use use = {.subject = what->subject->key,
                                  .token = failed ? what->actor : NULL,
                                  .appends = true};
    struct recording r = {.what = *what, .out = out};
    enum status st;

    *out = (struct store_recorded){.why = STORE_WAIT_NONE};
    st = store_start(s, what->actor, failed ? SQL_WRITE : SQL_LAZY, &use, &r.t, e);
    if (st != ST_OK)
        return st;
    store_read_ahead(&r.t, read_before, &r);
    if ((st = store_check(s, &r.t, e)) != ST_OK)
        return st;
    if ((st = read_before(&r, e)) == ST_OK)
        st = write_all(&r, e);
    return store_end(s, &r.t, st, e);
}

/* Prints the first of the last `days` days. */
static void days_begin(const struct log_txn *t, int days, char since[UTC_TEXT])
{
    const int64_t ms = days * INT64_C(86400000);

    utc_print(t->by.ms > ms ? t->by.ms - ms : 0, since);
    since[STORE_DAY] = '\0';
}

enum status store_days(struct store *s, struct store_day **out, size_t *n,
                       struct errinfo *e)
{
    char since[UTC_TEXT];
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    days_begin(&t, STORE_DAYS, since);
    return store_end(s, &t, rows_day_list(&t, since, out, n, e), e);
}

enum status store_scans(struct store *s, struct store_scans **out, size_t *n,
                        struct errinfo *e)
{
    char since[UTC_TEXT];
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    days_begin(&t, STORE_SCAN_DAYS, since);
    return store_end(s, &t, rows_scan_list(&t, since, out, n, e), e);
}

enum status store_days_trim(struct store *s, struct errinfo *e)
{
    const struct store_use use = {.subject = 0};
    char scores[UTC_TEXT], scans[UTC_TEXT];
    struct log_txn t;
    enum status st = store_begin_use(s, NULL, SQL_LAZY, &use, &t, e);

    if (st != ST_OK)
        return st;
    days_begin(&t, STORE_DAYS, scores);
    days_begin(&t, STORE_SCAN_DAYS, scans);
    if ((st = SQL_RUN(t.sql, e, "DELETE FROM days WHERE day < $1", sql_text(scores))) ==
        ST_OK)
        st = SQL_RUN(t.sql, e, "DELETE FROM scans WHERE day < $1", sql_text(scans));
    return store_end(s, &t, st, e);
}
