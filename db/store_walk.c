#include "store_walk.h"

#include <string.h>

#include "errinfo.h"
#include "row_entry.h"
#include "row_event.h"
#include "store_txn.h"

#define COL_MARK ROW_ENTRY_N /* a checkpoint behind the columns of an entry */

/* The end of the uses as the last entry of changes names it. */
struct bound {
    uint64_t seq;
    unsigned char hash[STORE_CHAIN_HASH];
};

static void step(struct store_chain_walk *w, const struct sql_rows *from,
                 struct bound *bound)
{
    struct store_chain_mark m;
    struct row_entry r;
    const bool sound = row_entry_read(from, &r);
    const struct store_chain_entry entry = row_entry_chain(&r);

    if (sound)
        store_chain_step(w, &entry, r.hash);
    else
        store_chain_damaged(w, r.seq);
    if (sound && r.nuses_hash != 0) {
        bound->seq = r.uses;
        memcpy(bound->hash, r.uses_hash, sizeof bound->hash);
    }
    if (sql_column(from, COL_MARK).type != SQL_NULL) {
        if (row_entry_mark(from, COL_MARK, &m))
            store_chain_pass(w, &m);
        else
            store_chain_problem(w, r.seq, "its checkpoint is damaged");
    } else if (sound && store_chain_due(r.seq, entry.kind)) {
        store_chain_problem(w, r.seq, "its checkpoint is missing");
    }
}

static enum status walk(struct store_txn *t, struct store_chain_walk *w,
                        struct bound *bound, uint64_t *entries, struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT " ROW_ENTRY_COLUMNS ", c.chain, c.seq, c.at, c.hash, c.signature "
        "FROM events e LEFT JOIN checkpoints c ON c.chain = e.chain AND c.seq = e.seq "
        "WHERE e.chain = $1 ORDER BY e.seq",
        sql_int(w->chain));

    while (st == ST_OK && sql_next(r)) {
        step(w, r, bound);
        ++*entries;
    }
    return sql_done(r, st, e);
}

/* Checkpoints of entries that are not there; the signature tells whether they ever were. */
static enum status walk_alone(struct store_txn *t, struct store_chain_walk *w,
                              struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT chain, seq, at, hash, signature FROM checkpoints c "
                  "WHERE chain = $1 AND NOT EXISTS (SELECT 1 FROM events e "
                  "WHERE e.chain = c.chain AND e.seq = c.seq) ORDER BY seq",
                  sql_int(w->chain));

    while (st == ST_OK && sql_next(r)) {
        struct store_chain_mark m;

        if (!row_entry_mark(r, 0, &m))
            store_chain_problem(w, m.seq, "its checkpoint is damaged");
        else
            store_chain_pass(w, &m);
    }
    return sql_done(r, st, e);
}

/* The end of the chain, as it is recorded. */
static enum status stop(struct store_txn *t, struct store_chain_walk *w,
                        struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    struct errinfo why = {0};
    uint64_t seq;
    const enum status st = row_event_end(t, w->chain, &seq, hash, &why);

    if (st == ST_OK) {
        store_chain_stop(w, seq, hash);
    } else if (st == ST_ECORRUPT) {
        store_chain_stop(w, w->seq, w->hash);
        store_chain_problem(w, w->seq, why.msg);
    } else {
        return errinfo_set(e, st, "%s", why.msg);
    }
    return walk_alone(t, w, e);
}

void store_walk_add(struct store_audit *out, const struct store_chain_walk *w)
{
    out->checkpoints += w->marks;
    out->problems += w->problems;
    if (out->first == 0 && w->problems > 0) {
        out->chain = w->chain;
        out->first = w->first;
    }
}

static enum status verify(struct store_txn *t, const unsigned char public[VAULT_KEY],
                          store_chain_report *report, void *arg, struct store_audit *out,
                          struct errinfo *e)
{
    struct store_chain_walk w;
    struct bound bound = {.seq = 0};
    bool has = true;
    enum status st;

    store_chain_walk(&w, STORE_CHAIN_CHANGES, public, report, arg);
    if ((st = walk(t, &w, &bound, &out->entries, e)) != ST_OK ||
        (st = stop(t, &w, e)) != ST_OK)
        return st;
    store_walk_add(out, &w);
    store_chain_walk(&w, STORE_CHAIN_USES, public, report, arg);
    if ((st = walk(t, &w, &bound, &out->entries, e)) != ST_OK ||
        (st = stop(t, &w, e)) != ST_OK ||
        (st = row_event_has(t, STORE_CHAIN_USES, bound.seq, bound.hash, &has, e)) !=
            ST_OK)
        return st;
    if (!has)
        store_chain_problem(&w, bound.seq,
                            "it is not the one that was the last when the last change "
                            "was made");
    store_walk_add(out, &w);
    return ST_OK;
}

enum status store_audit_verify(struct store *s, store_chain_report *report, void *arg,
                               struct store_audit *out, struct errinfo *e)
{
    unsigned char public[VAULT_KEY];
    struct store_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    vault_public(t.vault, public);
    return store_txn_end(&t, verify(&t, public, report, arg, out, e), e);
}
