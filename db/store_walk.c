#include "store_walk.h"

#include <inttypes.h>
#include <string.h>

#include "errinfo.h"
#include "row_check.h"
#include "row_event.h"
#include "store_txn.h"

#define COL_MARK ROW_ENTRY_N /* a checkpoint behind the columns of an entry */

/* The end of the uses as the last entry of changes names it. */
struct bound {
    uint64_t seq;
    unsigned char hash[STORE_CHAIN_HASH];
};

struct walking {
    struct store_chain_walk *uses; /* that of the other chain, for where it begins */
    struct store_chain_walk *w;
    struct row_check *rows;
    struct bound bound;
};

static enum status step(struct walking *x, const struct sql_rows *from, struct errinfo *e)
{
    struct store_chain_walk *w = x->w;
    struct store_chain_mark m;
    struct row_entry r;
    const bool sound = row_entry_read(from, &r);
    const struct store_chain_entry entry = row_entry_chain(&r);

    if (sound)
        store_chain_step(w, &entry, r.hash);
    else
        store_chain_damaged(w, r.seq);
    if (sound && r.nuses_hash != 0) {
        x->bound.seq = r.uses;
        memcpy(x->bound.hash, r.uses_hash, sizeof x->bound.hash);
        store_chain_base(x->uses, &entry);
    }
    if (sql_column(from, COL_MARK).type != SQL_NULL) {
        if (row_entry_mark(from, COL_MARK, &m))
            store_chain_pass(w, &m);
        else
            store_chain_problem(w, r.seq, "its checkpoint is damaged");
    } else if (sound && store_chain_due(r.seq, entry.kind)) {
        store_chain_problem(w, r.seq, "its checkpoint is missing");
    }
    return w->chain == STORE_CHAIN_CHANGES ? row_check_add(x->rows, &r, e) : ST_OK;
}

static enum status walk(struct store_txn *t, struct walking *x, uint64_t *entries,
                        struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT " ROW_ENTRY_COLUMNS ", c.chain, c.seq, c.at, c.hash, c.signature "
        "FROM events e LEFT JOIN checkpoints c ON c.chain = e.chain AND c.seq = e.seq "
        "WHERE e.chain = $1 ORDER BY e.seq",
        sql_int(x->w->chain));

    while (st == ST_OK && sql_next(r)) {
        st = step(x, r, e);
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

static void report_row(void *arg, uint64_t seq, const char *line)
{
    store_chain_problem(arg, seq, line);
}

static enum status walk_chain(struct store_txn *t, struct walking *x,
                              struct store_chain_walk *w, uint64_t *entries,
                              struct errinfo *e)
{
    enum status st;

    x->w = w;
    st = walk(t, x, entries, e);
    return st == ST_OK ? stop(t, w, e) : st;
}

/* The uses, which end where the last change says or later; there may have been none since it cut
 * them off. */
static enum status walk_uses(struct store_txn *t, struct walking *x,
                             struct store_chain_walk *w, uint64_t *entries,
                             struct errinfo *e)
{
    const bool none =
        x->bound.seq == w->seq && memcmp(x->bound.hash, w->hash, sizeof w->hash) == 0;
    bool has = true;
    enum status st = walk_chain(t, x, w, entries, e);

    if (st != ST_OK || none)
        return st;
    st = row_event_has(t, STORE_CHAIN_USES, x->bound.seq, x->bound.hash, &has, e);
    if (st != ST_OK)
        return st;
    if (!has)
        store_chain_problem(w, x->bound.seq,
                            "it is not the one that was the last when the last change "
                            "was made");
    return ST_OK;
}

static enum status hold_rows(struct store_txn *t, struct walking *x,
                             struct store_chain_walk *changes, struct errinfo *e)
{
    const uint64_t first = changes->first;
    enum status st;

    x->rows->last = changes->end;
    st = row_check_rows(x->rows, t, report_row, changes, e);
    if (first != 0) /* what is wrong with rows follows from what is wrong with entries */
        changes->first = first;
    return st;
}

/* The changes, the uses unless the store is to serve, and the rows.  *broken: problems of the
 * changes themselves. */
static enum status verify(struct store *s, bool serves, store_chain_report *report,
                          void *arg, struct store_audit *out, uint64_t *broken,
                          struct errinfo *e)
{
    unsigned char public[VAULT_KEY];
    struct store_chain_walk w[STORE_CHAINS];
    struct row_check rows = {.n = 0};
    struct walking x = {.rows = &rows, .uses = &w[STORE_CHAIN_USES]};
    struct store_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    vault_public(t.vault, public);
    for (int i = 0; i < STORE_CHAINS; i++)
        store_chain_walk(&w[i], (enum store_chain)i, public, report, arg);
    st = walk_chain(&t, &x, &w[STORE_CHAIN_CHANGES], &out->entries, e);
    if (st == ST_OK && !store_chain_signs(&w[STORE_CHAIN_CHANGES], public))
        store_chain_problem(&w[STORE_CHAIN_CHANGES], w[STORE_CHAIN_CHANGES].seq,
                            "the key that signs it is not the database's");
    store_chain_keys(&w[STORE_CHAIN_USES], &w[STORE_CHAIN_CHANGES]);
    *broken = w[STORE_CHAIN_CHANGES].problems;
    if (st == ST_OK && !serves)
        st = walk_uses(&t, &x, &w[STORE_CHAIN_USES], &out->entries, e);
    if (st == ST_OK)
        st = hold_rows(&t, &x, &w[STORE_CHAIN_CHANGES], e);
    if (st == ST_OK && serves && *broken == 0 &&
        !row_check_latest(&rows, &s->heads.latest))
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
    row_check_free(&rows);
    for (int i = 0; i < STORE_CHAINS; i++)
        store_walk_add(out, &w[i]);
    return store_txn_end(&t, st, e);
}

enum status store_audit_verify(struct store *s, store_chain_report *report, void *arg,
                               struct store_audit *out, struct errinfo *e)
{
    uint64_t broken;

    return verify(s, false, report, arg, out, &broken, e);
}

enum status store_state_verify(struct store *s, store_chain_report *report, void *arg,
                               struct store_audit *out, struct errinfo *e)
{
    uint64_t broken = 0;
    const enum status st = verify(s, true, report, arg, out, &broken, e);

    if (st != ST_OK || broken == 0)
        return st;
    return errinfo_set(e, ST_EREFUSED,
                       "the audit log of changes is not what was written, from entry "
                       "%" PRIu64 " on: surfacectl audit verify tells more, restore a "
                       "backup",
                       out->first);
}
