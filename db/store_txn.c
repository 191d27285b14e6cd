#include "store_txn.h"

#include "log_anchor.h"
#include "sql_file.h"

#define SCRUB_MS 200 /* that an erasure waits for readers */

/* What was found of the database as a whole stands until it is opened again. */
enum status store_refuse(struct store *s, enum status st, const struct errinfo *why,
                         struct errinfo *e)
{
    if (st == ST_EREFUSED && s->open)
        store_state_set(&s->refusal, why);
    return errinfo_set(e, st, "%s", why->msg);
}

/* Nothing is written on top of what was not verified. */
static enum status check(struct store *s, struct log_txn *t, const struct log_end *before,
                         struct errinfo *e)
{
    enum status st;

    if ((st = sql_file_in_place(t->sql, e)) != ST_OK ||
        (st = log_txn_begin(t, before, e)) != ST_OK || t->how == SQL_READ ||
        atomic_load(&s->verified))
        return st;
    if (t->how == SQL_TRY)
        return errinfo_set(e, ST_EBUSY, "the rows are not verified yet");
    if ((st = store_state_verify(t, NULL, NULL, e)) == ST_OK)
        atomic_store(&s->verified, true);
    return st;
}

enum status store_begin(struct store *s, enum sql_begin how, struct log_txn *t,
                        struct errinfo *e)
{
    const struct log_end before = log_newest(&s->log);
    struct errinfo why;
    enum status st;

    *t = (struct log_txn){.log = &s->log, .crypt = s->crypt, .how = how};
    if (store_state_get(&s->refusal, &why))
        return errinfo_set(e, ST_EREFUSED, "%s", why.msg);
    if ((st = sql_begin(s->sql, how, &t->sql, e)) != ST_OK)
        return st;
    if ((st = check(s, t, &before, &why)) == ST_OK)
        return ST_OK;
    (void)sql_end(t->sql, st, NULL);
    return store_refuse(s, st, &why, e);
}

enum status store_act_begin(struct store *s, const char *actor, enum sql_begin how,
                            struct log_act *by, struct log_txn *t, struct errinfo *e)
{
    const enum status st = log_act(by, actor, e);

    return st == ST_OK ? store_begin(s, how, t, e) : st;
}

/* Another process may have erased, and ended before the bytes had left the WAL. */
enum status store_end(struct store *s, struct log_txn *t, enum status st,
                      struct errinfo *e)
{
    struct errinfo why;
    bool changed;

    if (t->how == SQL_READ)
        return sql_end(t->sql, st, e);
    if (st == ST_OK)
        st = log_txn_check(t, e);
    if (st == ST_OK && atomic_exchange(&s->log.erasure, false))
        sql_file_scrub_later(s->sql);
    if ((st = sql_end(t->sql, st, e)) != ST_OK)
        return st;
    changed = t->changes.seq > log_newest(&s->log).seq;
    log_txn_committed(t);
    if (changed && s->anchor != NULL &&
        log_anchor_write(s->anchor, s->crypt, &t->changes, false, &why) != ST_OK)
        store_state_set(&s->anchor_fault, &why);
    return ST_OK;
}

void store_scrub(struct store *s)
{
    sql_file_scrub(s->sql, SCRUB_MS);
}
