#include "store_settle.h"

#include "errinfo.h"
#include "row_attempts.h"
#include "row_event.h"
#include "row_subject.h"
#include "store_rules.h"
#include "store_txn.h"

static enum status count_attempt(struct store_txn *t, const struct store_settle *what,
                                 const struct store_attempts *was, int64_t now,
                                 struct errinfo *e)
{
    if (what->as == STORE_SETTLE_FAILED)
        return row_attempts_fail(t, what->subject->id, now, e);
    if (what->as == STORE_SETTLE_PASSED && was->failures > 0)
        return row_attempts_clear(t, what->subject->id, e);
    return ST_OK;
}

static enum status write_all(struct store_txn *t, const struct store_settle *what,
                             const struct store_act *by, struct store_settled *out,
                             struct errinfo *e)
{
    const char *subject = what->subject->id;
    struct store_attempts was;
    struct errinfo why;
    bool future;
    enum status st = row_attempts_get(t, subject, by->ms, &was, &future, e);

    if (st != ST_OK)
        return st;
    out->may = what->may == NULL || what->may(what->arg, &was);
    if (!out->may)
        return ST_OK;
    if ((st = count_attempt(t, what, &was, by->ms, e)) != ST_OK)
        return st;
    st =
        row_event_use(t, by, what->kind, subject, what->template_id, what->outcome, &why);
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

    out->may = false;
    if ((st = store_rules_subject(what->subject->id, e)) != ST_OK ||
        (st = store_rules_event(what->kind, "", what->template_id, what->outcome, e)) !=
            ST_OK ||
        (st = store_rules_act(&by, what->actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_LAZY, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, write_all(&t, what, &by, out, e), e);
}
