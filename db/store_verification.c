#include "store_verification.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rows_attempts.h"
#include "rows_calibration.h"
#include "rows_day.h"
#include "rows_template.h"
#include "store_template.h"
#include "store_txn.h"

/* ---- what it reads */

struct store_reading {
    struct store *store;
    struct log_txn t;
    struct rows_subject of;
    struct rows_template *row; /* [n] of the snapshot */
    char token[STORE_NAME_MAX + 1];
    int64_t now;
    bool begun, future;
};

/* The subject and those of its templates that are asked for. */
static enum status read_templates(const struct store_snapshot_of *what,
                                  struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;
    enum status st;

    if (what->subject != NULL) {
        if ((st = rows_subject_find(&r->t, what->subject, &r->of, e)) != ST_OK ||
            (st = rows_template_list(&r->t, &r->of, &r->row, &out->n, e)) != ST_OK)
            return st;
    } else {
        if ((r->row = malloc(sizeof *r->row)) == NULL)
            return errinfo_set(e, ST_ENOMEM, "out of memory");
        if ((st = rows_template_get(&r->t, what->template_id, r->row, &r->of, e)) !=
            ST_OK)
            return st;
        out->n = 1;
    }
    if (out->n > STORE_TEMPLATES_MAX)
        return errinfo_set(e, ST_ECORRUPT, "subject %s has %zu templates, more than %d",
                           r->of.one.id, out->n, STORE_TEMPLATES_MAX);
    if ((out->t = malloc((out->n + 1) * sizeof *out->t)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    for (size_t i = 0; i < out->n; i++)
        out->t[i] = r->row[i].one;
    return ST_OK;
}

static enum status read_all(const struct store_snapshot_of *what,
                            struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r = out->reading;
    struct store_calibration k;
    enum status st = read_templates(what, out, e);

    if (st != ST_OK)
        return st;
    out->subject = r->of.one;
    out->subject.expired = store_rules_past(out->subject.expires, r->now);
    if ((st = rows_attempts_find(&r->t, out->subject.id, r->token, r->now, &out->attempts,
                                 &r->future, e)) != ST_OK)
        return st;
    if ((st = rows_calibration_get(&r->t, &k, e)) != ST_OK)
        return st == ST_ENOTFOUND ? ST_OK : st;
    out->calibration = k.version;
    if (k.version != what->calibration)
        out->k = k;
    return ST_OK;
}

/* What read_all() reads, all at once. */
static void snapshot_ahead(struct store_reading *r, const struct store_snapshot_of *what)
{
    struct store_calibration k;
    struct store_attempts now;
    struct rows_template one;
    size_t n;

    if (!sql_ahead(r->t.sql, true))
        return;
    if (what->subject != NULL) {
        (void)snprintf(r->of.one.id, sizeof r->of.one.id, "%s", what->subject);
        (void)rows_template_list(&r->t, &r->of, &r->row, &n, NULL);
        (void)rows_attempts_find(&r->t, what->subject, r->token, r->now, &now, &r->future,
                                 NULL);
        (void)rows_subject_find(&r->t, what->subject, &r->of, NULL);
    } else {
        (void)rows_template_get(&r->t, what->template_id, &one, &r->of, NULL);
    }
    (void)rows_calibration_get(&r->t, &k, NULL);
    (void)sql_ahead(r->t.sql, false);
}

enum status store_snapshot_begin(struct store *s, const struct store_snapshot_of *what,
                                 struct store_snapshot *out, struct errinfo *e)
{
    struct store_reading *r;
    enum status st;

    *out = (struct store_snapshot){.n = 0};
    if ((st = what->subject != NULL
                  ? ident_subject(what->subject, e)
                  : ident_id(what->template_id, "template", e)) != ST_OK)
        return st;
    if ((r = out->reading = calloc(1, sizeof *r)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    r->store = s;
    (void)snprintf(r->token, sizeof r->token, "%s",
                   what->token != NULL ? what->token : "");
    if ((st = store_rules_now(&r->now, e)) != ST_OK ||
        (st = store_start(s, SQL_READ, &r->t, e)) != ST_OK)
        return st;
    snapshot_ahead(r, what);
    if ((st = store_check(s, &r->t, e)) != ST_OK)
        return st;
    r->begun = true;
    return read_all(what, out, e);
}

enum status store_snapshot_face(const struct store_snapshot *out, size_t i,
                                struct surface_work *w, struct surface_face **f,
                                struct errinfo *e)
{
    struct store_reading *r = out->reading;
    unsigned char *face = NULL;
    size_t len = 0;
    enum status st = rows_template_face(&r->t, &r->row[i], &r->of, &face, &len, e);

    if (st == ST_OK)
        st = store_template_decode(r->store, &out->t[i], face, len, w, f, e);
    rows_template_wipe(face, len);
    return st;
}

static enum status move_future(const struct store_reading *r,
                               const struct store_subject *one, struct errinfo *e)
{
    const struct store_use use = {.subject = one->key, .token = r->token};
    struct log_txn t;
    const enum status st = store_begin_use(r->store, SQL_LAZY, &use, &t, e);

    if (st != ST_OK)
        return st;
    return store_end(r->store, &t, rows_attempts_not_after(&t, one, r->token, r->now, e),
                     e);
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
        st = store_end(r->store, &r->t, st, e);
    /* also where the reading was refused: a lock-out must end some day */
    if (r->future && (moved = move_future(r, &out->subject, &why)) != ST_OK &&
        st == ST_OK)
        st = errinfo_set(e, moved, "%s", why.msg);
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

/* The id of the template that one of the probe's frames was made into; "": none was. */
static enum status find_same(struct log_txn *t, const struct store_record *what,
                             char id[STORE_ID_LEN + 1], struct errinfo *e)
{
    const struct store_probe *p = what->probe;
    enum status st = ST_OK;

    id[0] = '\0';
    for (size_t i = 0; st == ST_OK && id[0] == '\0' && p->read[i] != NULL; i++)
        st = rows_template_same(t, what->subject->uid, p->used, p->read[i], id, e);
    return st;
}

/* A match by a scan that is no new one is no match. */
static enum status look_back(struct log_txn *t, struct store_record *what,
                             struct store_recorded *out, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1] = "";
    enum status st;

    if (what->probe == NULL)
        return ST_OK;
    st = find_same(t, what, id, e);
    if (st != ST_OK || (id[0] == '\0' && !what->replayed))
        return st;
    out->replayed = true;
    what->outcome = "replayed";
    if (what->as == STORE_RECORD_PASSED)
        what->as = STORE_RECORD_FAILED;
    return ST_OK;
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
    if (st == ST_OK && (out->warnings & 1U << STORE_ATTEMPTS_PATTERN) != 0)
        st = rows_attempts_told(t, what->subject, e);
    return st;
}

static enum status add_events(struct log_txn *t, const struct store_record *what,
                              const struct log_act *by, const struct store_recorded *out,
                              struct errinfo *e)
{
    static const char *const kind[STORE_WARNINGS] = {"locked_out", "many_subjects",
                                                     "attempts_pattern"};
    const unsigned char *uid = what->subject->uid;
    char outcome[STORE_WARNINGS][LOG_TEXT + 1];
    enum status st =
        log_access(t, by, what->kind, uid, what->template_id, what->outcome, e);

    (void)snprintf(outcome[STORE_LOCKED_OUT], sizeof outcome[0], "%" PRIu64 " failures",
                   (uint64_t)out->now.failures + out->now.others + 1);
    (void)snprintf(outcome[STORE_MANY_SUBJECTS], sizeof outcome[0],
                   "%" PRIu32 " subjects", out->now.tried_warn + 1);
    (void)snprintf(outcome[STORE_ATTEMPTS_PATTERN], sizeof outcome[0],
                   "failures between matches");
    for (unsigned i = 0; st == ST_OK && i < STORE_WARNINGS; i++)
        if ((out->warnings & 1U << i) != 0)
            st = log_access(t, by, kind[i], uid, "", outcome[i], e);
    return st;
}

static enum status write_all(struct log_txn *t, const struct store_record *asked,
                             const struct log_act *by, struct store_recorded *out,
                             struct errinfo *e)
{
    struct store_record what = *asked;
    bool future;
    enum status st =
        rows_attempts_get(t, what.subject, what.actor, by->ms, &out->now, &future, e);

    if (st != ST_OK)
        return st;
    out->wait_ms = store_attempts_wait_ms(what.limits, &out->now, &out->why);
    if (out->why != STORE_WAIT_NONE)
        return ST_OK;
    if ((st = look_back(t, &what, out, e)) != ST_OK)
        return st;
    if ((what.decision != NULL && !out->replayed &&
         (st = rows_day_count(t, by->at, what.decision, what.score, e)) != ST_OK) ||
        (st = store_record_attempt(t, &what, by->ms, out, e)) != ST_OK ||
        (st = add_events(t, &what, by, out, e)) != ST_OK ||
        store_rules_recent(what.subject->seen, by->ms))
        return st;
    return rows_subject_seen(t, what.subject->uid, by->at, e);
}

/* What write_all() reads, all at once. */
static void record_ahead(struct log_txn *t, const struct store_record *what,
                         const struct log_act *by)
{
    struct store_attempts now;
    char id[STORE_ID_LEN + 1];
    bool future;

    if (!sql_ahead(t->sql, true))
        return;
    (void)store_actor_may(t, by, NULL);
    (void)rows_attempts_get(t, what->subject, what->actor, by->ms, &now, &future, NULL);
    if (what->probe != NULL)
        (void)find_same(t, what, id, NULL);
    if (what->decision != NULL)
        rows_day_ahead(t, by->at, what->decision);
    log_txn_ahead(t);
    (void)sql_ahead(t->sql, false);
}

enum status store_record_verification(struct store *s, const struct store_record *what,
                                      struct store_recorded *out, struct errinfo *e)
{
    const bool failed = what->as == STORE_RECORD_FAILED;
    const struct store_use use = {.subject = what->subject->key,
                                  .token = failed ? what->actor : NULL,
                                  .appends = true};
    struct log_act by;
    struct log_txn t;
    enum status st;

    *out = (struct store_recorded){.why = STORE_WAIT_NONE};
    if ((st = log_act(&by, what->actor, e)) != ST_OK ||
        (st = store_start_use(s, failed ? SQL_WRITE : SQL_LAZY, &use, &t, e)) != ST_OK)
        return st;
    record_ahead(&t, what, &by);
    if ((st = store_check(s, &t, e)) != ST_OK)
        return st;
    if ((st = store_actor_may(&t, &by, e)) == ST_OK)
        st = write_all(&t, what, &by, out, e);
    return store_end(s, &t, st, e);
}

enum status store_days(struct store *s, struct store_day **out, size_t *n,
                       struct errinfo *e)
{
    const int64_t long_ms = STORE_DAYS * INT64_C(86400000);
    char since[UTC_TEXT];
    struct log_txn t;
    int64_t now;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_rules_now(&now, e)) != ST_OK ||
        (st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    utc_print(now > long_ms ? now - long_ms : 0, since);
    since[STORE_DAY] = '\0';
    return store_end(s, &t, rows_day_list(&t, since, out, n, e), e);
}
