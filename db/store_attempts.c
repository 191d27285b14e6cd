#include "store_attempts.h"

#include <sodium.h>
#include <string.h>

#include "options.h"
#include "rows_attempts.h"
#include "rows_subject.h"
#include "rows_token.h"
#include "store_txn.h"

static enum status reset(struct log_txn *t, const char *subject, struct errinfo *e)
{
    struct rows_subject of;
    enum status st = rows_subject_find(t, subject, &of, e);

    sodium_memzero(of.key, sizeof of.key);
    if (st != ST_OK || (st = store_lock_subject(t, of.one.key, e)) != ST_OK ||
        (st = rows_attempts_clear(t, &of.one, e)) != ST_OK)
        return st;
    return log_change(t, "reset_attempts", of.one.uid, "", "", e);
}

enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, reset(&t, subject, e), e);
}

static enum status reset_token(struct log_txn *t, const char *token, struct errinfo *e)
{
    struct rows_token one;
    enum status st = rows_token_get(t, token, &one, e);

    if (st != ST_OK || (st = store_lock_token(t, token, e)) != ST_OK ||
        (st = rows_attempts_revoke(t, token, e)) != ST_OK)
        return st;
    return log_change(t, "reset_attempts", NULL, token, one.token.name, e);
}

enum status store_attempts_reset_token(struct store *s, const char *actor,
                                       const char *token, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    if ((st = ident_id(token, "token", e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, reset_token(&t, token, e), e);
}

enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, rows_attempts_list(&t, t.by.ms, out, n, e), e);
}

/* How long a lock-out lasts after this many failures in a row: 0 below limit, wait_s s at limit,
 * twice as long with each further one, most_s s at most. */
static int64_t lockout_ms(unsigned limit, unsigned wait_s, unsigned most_s,
                          uint64_t failures)
{
    int64_t wait = wait_s;

    if (failures < limit)
        return 0;
    for (uint64_t i = limit; i < failures && wait < most_s; i++)
        wait *= 2;
    return 1000 * (wait < most_s ? wait : most_s);
}

/* What is left of a lock-out of at most most_s after this number of failures. */
static int64_t left_ms(const struct store_limits *l, uint64_t failures, int64_t age_ms,
                       unsigned most_s)
{
    const int64_t wait_ms = lockout_ms(l->failures, l->wait_s, most_s, failures);

    return age_ms < wait_ms ? wait_ms - age_ms : 0;
}

/* What is left of the lock-out by the failures of all tokens. */
static int64_t shared_ms(const struct store_limits *l, const struct store_attempts *now)
{
    const bool own = now->failures > 0;
    const int64_t age_ms =
        own && now->age_ms < now->others_age_ms ? now->age_ms : now->others_age_ms;

    if (now->others == 0)
        return 0;
    return left_ms(l, (uint64_t)now->failures + now->others, age_ms,
                   own ? STORE_WAIT_SHARED_S : STORE_WAIT_OTHERS_S);
}

/* What is left of the token's wait for a subject that is not one of those that it has tried. */
static int64_t tried_ms(const struct store_limits *l, const struct store_attempts *now)
{
    if (l->subjects == 0 || now->token[0] == '\0' || now->tried < l->subjects ||
        (now->failures > 0 && now->age_ms < STORE_TRIED_MS) ||
        now->tried_age_ms >= STORE_TRIED_MS / l->subjects)
        return 0;
    return STORE_TRIED_MS / l->subjects - now->tried_age_ms;
}

int64_t store_attempts_wait_ms(const struct store_limits *l,
                               const struct store_attempts *now, enum store_wait *why)
{
    int64_t wait[] = {[STORE_WAIT_NONE] = 0,
                      [STORE_WAIT_OWN] = 0,
                      [STORE_WAIT_OTHERS] = 0,
                      [STORE_WAIT_SUBJECTS] = 0};

    *why = STORE_WAIT_NONE;
    if (l == NULL || l->failures == 0)
        return 0;
    wait[STORE_WAIT_OWN] = left_ms(l, now->failures, now->age_ms, OPTIONS_WAIT_MAX);
    wait[STORE_WAIT_OTHERS] = shared_ms(l, now);
    wait[STORE_WAIT_SUBJECTS] = tried_ms(l, now);
    for (enum store_wait i = STORE_WAIT_OWN; i <= STORE_WAIT_SUBJECTS; i++)
        if (wait[i] > wait[*why])
            *why = i;
    return wait[*why];
}

uint32_t store_attempts_suspicion(const struct store_attempts *was, bool failed)
{
    const bool unexplained = was->failures > 0 && was->age_ms > STORE_RETRY_MS;
    const uint32_t more = was->suspicion + (unexplained ? 6 : 0);

    if (failed)
        return more < 999997 ? more + 3 : 1000000;
    return more > 2 ? more - 2 : 0;
}

/* ---- of a subject */

struct worst {
    struct log_txn *t;
    const struct store_subject *subject;
    const struct store_limits *limits;
    int64_t now, wait_ms;
    uint32_t failures;
};

static enum status look_at(void *arg, const char *token, struct errinfo *e)
{
    struct worst *w = arg;
    struct store_attempts a;
    enum store_wait why;
    int64_t wait_ms;
    bool future;
    const enum status st =
        rows_attempts_get(w->t, w->subject, token, w->now, &a, &future, e);

    a.tried = 0; /* other subjects' */
    wait_ms = store_attempts_wait_ms(w->limits, &a, &why);
    w->wait_ms = wait_ms > w->wait_ms ? wait_ms : w->wait_ms;
    w->failures = a.failures > w->failures ? a.failures : w->failures;
    return st;
}

enum status store_attempts_longest(struct log_txn *t, const struct store_subject *subject,
                                   const struct store_limits *l, int64_t now,
                                   struct store_worst *out, struct errinfo *e)
{
    static const char another[] = "*"; /* no token's id */
    struct worst w = {.t = t, .subject = subject, .limits = l, .now = now};
    enum status st = rows_attempts_each(t, subject, look_at, &w, e);

    if (st == ST_OK && w.failures > 0) /* else none is locked out */
        st = look_at(&w, another, e);
    memset(out, 0, sizeof *out);
    out->failures = w.failures;
    if (st == ST_OK && w.wait_ms > 0)
        utc_print(now + w.wait_ms, out->until);
    return st;
}

enum status store_attempts_worst(struct store *s, const char *actor, const char *subject,
                                 const struct store_limits *l, struct store_worst *out,
                                 struct errinfo *e)
{
    struct rows_subject of;
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = ident_subject(subject, e)) != ST_OK ||
        (st = store_act_begin(s, actor, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = rows_subject_find(&t, subject, &of, e)) == ST_OK)
        st = store_attempts_longest(&t, &of.one, l, t.by.ms, out, e);
    sodium_memzero(&of, sizeof of);
    return store_end(s, &t, st, e);
}
