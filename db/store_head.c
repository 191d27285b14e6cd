#include "store_head.h"

#include <inttypes.h>
#include <sodium.h>
#include <string.h>

#include "errinfo.h"
#include "row_entry.h"
#include "sql.h"
#include "store_column.h"

void store_head_init(struct store_heads *h)
{
    (void)pthread_mutex_init(&h->lock, NULL);
    store_latest_init(&h->latest);
}

void store_head_free(struct store_heads *h)
{
    (void)pthread_mutex_destroy(&h->lock);
    store_latest_free(&h->latest);
}

struct store_head store_head_now(struct store_heads *h)
{
    struct store_head now;

    (void)pthread_mutex_lock(&h->lock);
    now = h->newest;
    (void)pthread_mutex_unlock(&h->lock);
    return now;
}

static bool is_same(const struct store_head *a, const struct store_head *b)
{
    return a->known && a->seq == b->seq && memcmp(a->hash, b->hash, sizeof a->hash) == 0;
}

static void remember(struct store_heads *h, const struct store_head *seen)
{
    (void)pthread_mutex_lock(&h->lock);
    if (!h->newest.known || seen->seq > h->newest.seq) {
        const uint64_t least = h->newest.least;

        h->newest = *seen;
        h->newest.least = least;
    }
    (void)pthread_mutex_unlock(&h->lock);
}

void store_head_made(struct store_heads *h, uint64_t seq)
{
    (void)pthread_mutex_lock(&h->lock);
    if (seq > h->newest.least)
        h->newest.least = seq;
    (void)pthread_mutex_unlock(&h->lock);
}

/* known: it has the MAC of the database's key. */
static enum status read_end(struct sql_txn *t, const struct vault *v,
                            const struct store_head *before, struct store_head *out,
                            struct errinfo *e)
{
    unsigned char mac[STORE_CHAIN_HASH], wanted[STORE_CHAIN_HASH];
    struct sql_rows *r;
    const enum status st = sql_query(
        t, "SELECT seq, hash, mac FROM events_end WHERE chain = 0", NULL, 0, &r, e);

    memset(out, 0, sizeof *out);
    if (st == ST_OK && sql_next(r) &&
        store_column_bytes(r, 1, out->hash, sizeof out->hash) &&
        store_column_bytes(r, 2, mac, sizeof mac)) {
        out->seq = (uint64_t)sql_column(r, 0).i;
        out->known = is_same(before, out); /* it was looked at then */
        if (!out->known) {
            store_chain_end(v, STORE_CHAIN_CHANGES, out->seq, out->hash, wanted);
            out->known = sodium_memcmp(mac, wanted, sizeof mac) == 0;
        }
    }
    return sql_done(r, st, e);
}

/* The entries that were added: each follows from the one before, the last one is the end. */
static enum status follow(struct store_heads *h, struct sql_txn *t,
                          const struct store_head *before, const struct store_head *end,
                          bool *follows, struct errinfo *e)
{
    struct store_head at = *before;
    struct row_entry entry;
    struct sql_rows *r;
    enum status st = SQL_QUERY(t, &r, e,
                               "SELECT " ROW_ENTRY_COLUMNS " FROM events e "
                               "WHERE e.chain = 0 AND e.seq > $1 ORDER BY e.seq",
                               sql_int((int64_t)before->seq));

    *follows = true;
    while (st == ST_OK && *follows && sql_next(r)) {
        *follows = row_entry_read(r, &entry) && entry.seq == at.seq + 1;
        if (*follows) {
            const struct store_chain_entry hashed = row_entry_chain(&entry);

            store_chain_next(at.hash, &hashed, at.hash);
            at.seq = entry.seq;
            *follows = memcmp(at.hash, entry.hash, sizeof at.hash) == 0;
            if (entry.nobject != 0 &&
                !store_latest_add(&h->latest, entry.object, at.seq,
                                  entry.nrow != 0 ? entry.row : NULL))
                st = errinfo_set(e, ST_ENOMEM, "out of memory");
        }
    }
    *follows = *follows && is_same(&at, end);
    return sql_done(r, st, e);
}

static enum status refuse(const struct store_head *before, const char *what,
                          struct errinfo *e)
{
    return errinfo_set(e, ST_EREFUSED,
                       "the database is not as this program has seen it: %s its change "
                       "%" PRIu64,
                       what, before->seq);
}

enum status store_head_see(struct store_heads *h, struct sql_txn *t,
                           const struct vault *v, const struct store_head *before,
                           uint64_t *seq, struct errinfo *e)
{
    struct store_head end;
    bool follows = false;
    enum status st = read_end(t, v, before, &end, e);

    *seq = end.seq;
    if (st != ST_OK || (is_same(before, &end) && end.seq >= before->least))
        return st;
    if (before->known) {
        if (!end.known)
            return refuse(before, "its audit log has no end after", e);
        if (end.seq < before->seq || end.seq < before->least)
            return refuse(before, "it is an older one, without", e);
        if ((st = follow(h, t, before, &end, &follows, e)) != ST_OK)
            return st;
        if (!follows)
            return refuse(before, "its audit log is another one from", e);
    }
    if (end.known)
        remember(h, &end);
    return ST_OK;
}
