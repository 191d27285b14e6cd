#include "store_settle.h"

#include <inttypes.h>
#include <stdio.h>

#include "errinfo.h"
#include "row_attempts.h"
#include "row_cloud.h"
#include "row_event.h"
#include "row_subject.h"
#include "store_rules.h"
#include "store_txn.h"

/* A match by a scan that is no new one is none. */
static enum status look_back(struct store_txn *t, struct store_settle *what,
                             struct store_settled *out, struct errinfo *e)
{
    enum status st;

    if (what->probe == NULL)
        return ST_OK;
    st = row_cloud_known(t, what->subject, what->probe, &out->replayed, e);
    if (!out->replayed)
        return st;
    what->outcome = "replayed";
    if (what->as == STORE_SETTLE_PASSED)
        what->as = STORE_SETTLE_FAILED;
    return st;
}

static enum status count_attempt(struct store_txn *t, const struct store_settle *what,
                                 const struct store_attempts *was, int64_t now,
                                 struct errinfo *e)
{
    if (what->as == STORE_SETTLE_FAILED)
        return row_attempts_fail(t, what->subject->id, what->actor, now, e);
    if (what->as == STORE_SETTLE_PASSED && was->failures > 0)
        return row_attempts_match(t, what->subject->id, what->actor, e);
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

static enum status add_events(struct store_txn *t, const struct store_settle *what,
                              const struct store_act *by,
                              const struct store_attempts *was,
                              const struct store_settled *out, struct errinfo *e)
{
    const char *subject = what->subject->id;
    char outcome[STORE_NAME_MAX + 1];
    enum status st =
        row_event_use(t, by, what->kind, subject, what->template_id, what->outcome, e);

    if (st == ST_OK && out->locked_out) {
        (void)snprintf(outcome, sizeof outcome, "%" PRIu32 " failures",
                       was->failures + 1);
        st = row_event_use(t, by, "locked_out", subject, "", outcome, e);
    }
    if (st == ST_OK && out->many_subjects) {
        (void)snprintf(outcome, sizeof outcome, "%" PRIu32 " subjects",
                       was->tried_warn + 1);
        st = row_event_use(t, by, "many_subjects", subject, "", outcome, e);
    }
    return st;
}

static enum status write_all(struct store_txn *t, const struct store_settle *asked,
                             const struct store_act *by, struct store_settled *out,
                             struct errinfo *e)
{
    struct store_settle settled = *asked, *what = &settled;
    const char *subject = what->subject->id;
    struct store_attempts was;
    struct errinfo why;
    bool future;
    enum status st = row_attempts_get(t, subject, what->actor, by->ms, &was, &future, e);

    if (st != ST_OK)
        return st;
    out->may = what->may == NULL || what->may(what->arg, &was);
    if (!out->may)
        return ST_OK;
    if ((st = look_back(t, what, out, e)) != ST_OK)
        return st;
    judge(what, &was, out);
    if ((st = count_attempt(t, what, &was, by->ms, e)) != ST_OK)
        return st;
    st = add_events(t, what, by, &was, out, &why);
    if (st != ST_OK && st != ST_ECORRUPT)
        return errinfo_set(e, st, "%s", why.msg);
    if (st == ST_ECORRUPT)
        (void)errinfo_set(out->lost, st, "%s", why.msg);
    if (store_rules_recent(what->subject->seen, by->ms))
        return ST_OK;
    return row_subject_seen(t, subject, by->at, e);
}

enum status store_settle(struct store *s, const struct store_settle *what,
                         struct store_settled *out, struct errinfo *e)
{
    struct store_act by;
    struct store_txn t;
    enum status st;

    out->may = out->replayed = out->locked_out = out->many_subjects = false;
    if ((st = store_rules_subject(what->subject->id, e)) != ST_OK ||
        (st = store_rules_event(what->kind, "", what->template_id, what->outcome, e)) !=
            ST_OK ||
        (st = store_rules_act(&by, what->actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_LAZY, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, write_all(&t, what, &by, out, e), e);
}
