#include "store_txn.h"

#include "errinfo.h"
#include "sql_file.h"

#define SCRUB_MS 200 /* that an erasure waits for readers */

enum status store_txn_refuse(struct store *s, struct errinfo *e)
{
    struct store_refusal *r = &s->refusal;

    e->code = ST_EREFUSED;
    if (s->open && !atomic_flag_test_and_set(&r->begun)) {
        r->why = *e;
        atomic_store(&r->stands, true);
    }
    return ST_EREFUSED;
}

static enum status use_vault(struct store *s, struct store_txn *t, struct errinfo *e)
{
    struct errinfo why;
    enum status st = store_vault_use(&s->vaults, t->sql, &t->held, &why);

    if (st == ST_OK) {
        t->vault = t->held->vault;
        return ST_OK;
    }
    if (st == ST_EREFUSED)
        (void)store_txn_refuse(s, &why);
    else if (s->open && (st == ST_EDENIED || st == ST_ENOTFOUND || st == ST_EINVAL))
        return errinfo_set(e, ST_EREFUSED, "the database's key was changed: %.400s",
                           why.msg);
    return errinfo_set(e, st, "%s", why.msg);
}

static enum status see_head(struct store_txn *t, const struct store_head *before,
                            struct errinfo *e)
{
    struct store *s = t->store;
    struct errinfo why;
    const enum status st =
        store_head_see(&s->heads, t->sql, t->vault, before, &t->head, &why);

    if (st == ST_EREFUSED)
        (void)store_txn_refuse(s, &why);
    return st == ST_OK ? st : errinfo_set(e, st, "%s", why.msg);
}

static enum status see_schema(struct store_txn *t, struct errinfo *e)
{
    struct errinfo why;
    const enum status st =
        t->how == SQL_READ ? ST_OK : sql_file_expect_schema(t->sql, &why);

    if (st == ST_EREFUSED)
        (void)store_txn_refuse(t->store, &why);
    return st == ST_OK ? st : errinfo_set(e, st, "%s", why.msg);
}

static void release(struct store_txn *t)
{
    store_vault_release(&t->store->vaults, t->held);
    t->held = NULL;
    t->vault = NULL;
}

enum status store_txn_begin(struct store *s, enum sql_begin how, struct store_txn *t,
                            struct errinfo *e)
{
    struct store_head before;
    enum status st;

    *t = (struct store_txn){.store = s, .how = how};
    if (atomic_load(&s->refusal.stands))
        return errinfo_set(e, ST_EREFUSED, "%s", s->refusal.why.msg);
    t->held = store_vault_take(&s->vaults);
    before = store_head_now(&s->heads);
    if ((st = sql_begin(s->sql, how, &t->sql, e)) == ST_OK &&
        ((st = see_schema(t, e)) != ST_OK || (st = use_vault(s, t, e)) != ST_OK ||
         (st = see_head(t, &before, e)) != ST_OK))
        (void)sql_end(t->sql, st, NULL);
    if (st != ST_OK)
        release(t);
    return st;
}

enum status store_txn_erasures(struct store_txn *t, int64_t after, int64_t *last,
                               bool *erased, struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT (SELECT coalesce(max(seq), 0) FROM events WHERE chain = 0), "
        "CASE WHEN EXISTS (SELECT 1 FROM events WHERE chain = 0 "
        "AND seq > $1 AND kind IN "
        "('delete_subject', 'delete_template', 'rekey', 'renew_key')) THEN 1 ELSE 0 END",
        sql_int(after));

    if (st == ST_OK && sql_next(r)) {
        *last = sql_column(r, 0).i;
        *erased = sql_column(r, 1).i != 0;
    }
    return sql_done(r, st, e);
}

/* Our own erasures are among them: where store_txn_scrub() has done its work, the next end of
 * a transaction has little to do. */
enum status store_txn_end(struct store_txn *t, enum status st, struct errinfo *e)
{
    struct store *s = t->store;
    struct anchor_end end;
    bool erased = false, changed = false;
    int64_t last = -1;

    if (t->how == SQL_READ) {
        st = sql_end(t->sql, st, e);
        release(t);
        return st;
    }
    if (st == ST_OK && t->how == SQL_WRITE)
        changed = store_anchor_end(t->sql, t->vault, &end, NULL) == ST_OK;
    if (st == ST_OK)
        (void)store_txn_erasures(t, atomic_load(&s->scrubbed), &last, &erased, NULL);
    if ((st = sql_end(t->sql, st, e)) == ST_OK && last >= 0)
        atomic_store(&s->scrubbed, last);
    if (st == ST_OK && erased)
        sql_file_scrub_later(s->sql);
    if (st == ST_OK && changed) {
        store_head_made(&s->heads, end.seq);
        store_anchor_tell(&s->anchor, t->vault, &end);
    }
    release(t);
    return st;
}

void store_txn_scrub(struct store *s)
{
    sql_file_scrub(s->sql, SCRUB_MS);
}

enum status store_txn_seen(struct store *s, struct errinfo *e)
{
    struct store_txn t;
    bool erased;
    int64_t last = 0;
    enum status st = store_txn_begin(s, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    st = store_txn_erasures(&t, INT64_MAX, &last, &erased, e);
    atomic_store(&s->scrubbed, last);
    return store_txn_end(&t, st, e);
}
