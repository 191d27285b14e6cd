#include "store_settle.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>

#include "rows_attempts.h"
#include "rows_template.h"
#include "store_rules.h"
#include "store_txn.h"

/* A match by a scan that is no new one is none. */
static enum status look_back(struct log_txn *t, struct store_settle *what,
                             struct store_settled *out, struct errinfo *e)
{
    char id[STORE_ID_LEN + 1] = "";
    struct rows_subject of;
    enum status st;

    if (what->probe == NULL)
        return ST_OK;
    if ((st = rows_subject_get(t, what->subject->uid, &of, e)) == ST_OK)
        st = rows_template_same(t, &of, what->probe->used, what->probe->read, id, e);
    sodium_memzero(of.key, sizeof of.key);
    if (st != ST_OK || id[0] == '\0')
        return st;
    out->replayed = true;
    what->outcome = "replayed";
    if (what->as == STORE_SETTLE_PASSED)
        what->as = STORE_SETTLE_FAILED;
    return ST_OK;
}

static enum status count_attempt(struct log_txn *t, const struct store_settle *what,
                                 const struct store_attempts *was, int64_t now,
                                 struct errinfo *e)
{
    if (what->as == STORE_SETTLE_FAILED)
        return rows_attempts_fail(t, what->subject, what->actor, now, e);
    if (what->as == STORE_SETTLE_PASSED && was->failures > 0)
        return rows_attempts_match(t, what->subject, what->actor, e);
    return ST_OK;
}

/* Each lock-out is told, and so many subjects that a token tried, and as many more. */
static void judge(const struct store_settle *what, const struct store_attempts *was,
                  struct store_settled *out)
{
    const uint32_t before =
        was->tried_warn + (was->failures > 0 && was->age_ms < STORE_TRIED_WARN_MS);
    const uint32_t after = was->tried_warn + 1;

    if (what->as != STORE_SETTLE_FAILED)
        return;
    out->locked_out = what->warn_failures > 0 && was->failures + 1 >= what->warn_failures;
    out->many_subjects = what->warn_tried > 0 && after > before &&
                         after / what->warn_tried > before / what->warn_tried;
}

static enum status add_events(struct log_txn *t, const struct store_settle *what,
                              const struct log_act *by, const struct store_attempts *was,
                              const struct store_settled *out, struct errinfo *e)
{
    const unsigned char *uid = what->subject->uid;
    char outcome[LOG_TEXT + 1];
    enum status st =
        log_access(t, by, what->kind, uid, what->template_id, what->outcome, e);

    if (st == ST_OK && out->locked_out) {
        (void)snprintf(outcome, sizeof outcome, "%" PRIu32 " failures",
                       was->failures + 1);
        st = log_access(t, by, "locked_out", uid, "", outcome, e);
    }
    if (st == ST_OK && out->many_subjects) {
        (void)snprintf(outcome, sizeof outcome, "%" PRIu32 " subjects",
                       was->tried_warn + 1);
        st = log_access(t, by, "many_subjects", uid, "", outcome, e);
    }
    return st;
}

static enum status write_all(struct log_txn *t, const struct store_settle *asked,
                             const struct log_act *by, struct store_settled *out,
                             struct errinfo *e)
{
    struct store_settle settled = *asked, *what = &settled;
    struct store_attempts was;
    bool future;
    enum status st =
        rows_attempts_get(t, what->subject, what->actor, by->ms, &was, &future, e);

    if (st != ST_OK)
        return st;
    out->may = what->may == NULL || what->may(what->arg, &was);
    if (!out->may)
        return ST_OK;
    if ((st = look_back(t, what, out, e)) != ST_OK)
        return st;
    judge(what, &was, out);
    if ((st = count_attempt(t, what, &was, by->ms, e)) != ST_OK ||
        (st = add_events(t, what, by, &was, out, e)) != ST_OK ||
        store_rules_recent(what->subject->seen, by->ms))
        return st;
    return rows_subject_seen(t, what->subject->uid, by->at, e);
}

enum status store_settle(struct store *s, const struct store_settle *what,
                         struct store_settled *out, struct errinfo *e)
{
    struct log_act by;
    struct log_txn t;
    enum status st;

    out->may = out->replayed = out->locked_out = out->many_subjects = false;
    if ((st = store_act_begin(s, what->actor,
                              what->as == STORE_SETTLE_FAILED ? SQL_WRITE : SQL_LAZY, &by,
                              &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, write_all(&t, what, &by, out, e), e);
}
