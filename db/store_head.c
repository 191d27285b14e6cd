#include "store_head.h"

#include <inttypes.h>
#include <string.h>

#include "errinfo.h"
#include "row_entry.h"
#include "row_event.h"
#include "store_column.h"
#include "store_txn.h"

void store_head_init(struct store_heads *h)
{
    (void)pthread_mutex_init(&h->lock, NULL);
}

void store_head_free(struct store_heads *h)
{
    (void)pthread_mutex_destroy(&h->lock);
}

struct store_head store_head_now(struct store_heads *h)
{
    struct store_head now;

    (void)pthread_mutex_lock(&h->lock);
    now = h->newest;
    (void)pthread_mutex_unlock(&h->lock);
    return now;
}

static void remember(struct store_heads *h, const struct store_head *seen)
{
    (void)pthread_mutex_lock(&h->lock);
    if (!h->newest.known || seen->seq > h->newest.seq)
        h->newest = *seen;
    (void)pthread_mutex_unlock(&h->lock);
}

void store_head_made(struct store_heads *h, uint64_t seq,
                     const unsigned char hash[STORE_CHAIN_HASH])
{
    struct store_head end = {.known = true, .seq = seq};

    memcpy(end.hash, hash, sizeof end.hash);
    remember(h, &end);
}

/* As it stands there: its MAC is looked at where it is another than before. */
static enum status read_end(struct store_txn *t, struct store_head *out,
                            struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = sql_query(
        t->sql, "SELECT seq, hash FROM events_end WHERE chain = 0", NULL, 0, &r, e);

    if (st == ST_OK && sql_next(r) &&
        store_column_bytes(r, 1, out->hash, sizeof out->hash)) {
        out->seq = (uint64_t)sql_column(r, 0).i;
        out->known = true;
    }
    return sql_done(r, st, e);
}

/* The entries that were added: each follows from the one before, the last one is the end. */
static enum status follow(struct store_txn *t, const struct store_head *before,
                          const struct store_head *end, bool *follows, struct errinfo *e)
{
    struct store_head at = *before;
    struct row_entry entry;
    struct sql_rows *r;
    const enum status st = SQL_QUERY(t->sql, &r, e,
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
                !store_latest_add(&t->store->latest, entry.object, at.seq))
                return sql_done(r, errinfo_set(e, ST_ENOMEM, "out of memory"), e);
        }
    }
    *follows =
        *follows && at.seq == end->seq && memcmp(at.hash, end->hash, sizeof at.hash) == 0;
    return sql_done(r, st, e);
}

static enum status refuse(struct store_txn *t, const struct store_head *before,
                          const char *what, struct errinfo *e)
{
    struct errinfo why;

    (void)errinfo_set(&why, ST_EREFUSED,
                      "the database is not as this program has seen it: %s its change "
                      "%" PRIu64,
                      what, before->seq);
    (void)store_txn_refuse(t->store, &why);
    return errinfo_set(e, ST_EREFUSED, "%s", why.msg);
}

enum status store_head_see(struct store_txn *t, const struct store_head *before,
                           struct errinfo *e)
{
    struct store_head end = {.known = false};
    struct errinfo why;
    bool follows = false;
    enum status st = read_end(t, &end, e);

    t->head = end.seq;
    if (st != ST_OK || (before->known && end.known && end.seq == before->seq &&
                        memcmp(end.hash, before->hash, sizeof end.hash) == 0))
        return st;
    st = row_event_end(t, STORE_CHAIN_CHANGES, &end.seq, end.hash, &why);
    if (st != ST_OK && st != ST_ECORRUPT)
        return errinfo_set(e, st, "%s", why.msg);
    end.known = st == ST_OK;
    if (before->known) {
        if (!end.known)
            return refuse(t, before, "its audit log has no end after", e);
        if (end.seq < before->seq)
            return refuse(t, before, "it is an older one, without", e);
        if ((st = follow(t, before, &end, &follows, e)) != ST_OK)
            return st;
        if (!follows)
            return refuse(t, before, "its audit log is another one from", e);
    }
    if (end.known)
        remember(&t->store->heads, &end);
    return ST_OK;
}
