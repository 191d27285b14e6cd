#include "store_serve.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <unistd.h>

#include "errinfo.h"
#include "row_event.h"
#include "store_open.h"
#include "store_rules.h"
#include "store_txn.h"

/* What the anchor knew was durable.  After a loss of power uses behind that may be lost: of these,
 * what is found is all that there is. */
static enum status say_gap(struct store_txn *t, const struct anchor *a,
                           const struct anchor_end *now, struct errinfo *e)
{
    char outcome[STORE_NAME_MAX + 1];
    struct store_act by;
    enum status st = store_rules_act(&by, "", e);

    (void)snprintf(outcome, sizeof outcome,
                   "known %" PRIu64 "/%" PRIu64 ", found %" PRIu64 "/%" PRIu64
                   " (changes/uses)",
                   a->last.seq, a->last.uses, now->seq, now->uses);
    return st == ST_OK ? row_event_add(t, &by, "unclean_stop", "", "", outcome, e) : st;
}

enum status store_serve(struct store *s, struct errinfo *e)
{
    struct anchor_end now;
    struct store_txn t;
    struct anchor a;
    bool alone = false;
    const int fd = anchor_serve(s->anchor.path, &alone, e);
    enum status st;

    if (fd < 0)
        return ST_EIO;
    if ((st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK) {
        (void)close(fd);
        return st;
    }
    if ((st = anchor_read(s->anchor.path, t.vault, &a, e)) == ST_OK &&
        (st = store_anchor_end(t.sql, t.vault, &now, e)) == ST_OK && alone &&
        (a.served || now.uses < a.last.uses))
        st = say_gap(&t, &a, &now, e);
    if (st == ST_OK)
        st = anchor_mark(s->anchor.path, t.vault, true, e);
    if ((st = store_txn_end(&t, st, e)) == ST_OK)
        s->anchor.serving = fd;
    else
        (void)close(fd);
    return st;
}

enum status store_last_change(struct store *s, uint64_t *seq, char hash[65],
                              struct errinfo *e)
{
    struct anchor_end now = {.seq = 0};
    struct store_txn t;
    enum status st;

    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    st = store_txn_end(&t, store_anchor_end(t.sql, t.vault, &now, e), e);
    *seq = now.seq;
    (void)sodium_bin2hex(hash, 65, now.hash, sizeof now.hash);
    return st;
}

bool store_anchor_fault(struct store *s, struct errinfo *e)
{
    if (!atomic_load(&s->anchor.fault))
        return false;
    *e = s->anchor.why;
    return true;
}

/* ---- a rollback on purpose */

/* *now: the end after the entry, which is durable when the transaction is committed. */
static enum status accept(struct store_txn *t, const char *anchor, const char *actor,
                          char outcome[STORE_NAME_MAX + 1], struct anchor_end *now,
                          struct errinfo *e)
{
    struct store_act by;
    struct anchor a;
    bool agrees = false;
    enum status st = anchor_read(anchor, t->vault, &a, e);

    if (st == ST_ENOTFOUND)
        (void)snprintf(outcome, STORE_NAME_MAX + 1, "the anchor was missing");
    else if (st == ST_EREFUSED)
        (void)snprintf(outcome, STORE_NAME_MAX + 1, "the anchor was not its own");
    else if (st != ST_OK ||
             (st = store_anchor_agrees(t->sql, t->vault, &a, now, &agrees, e)) != ST_OK)
        return st;
    else if (agrees)
        return errinfo_set(
            e, ST_EINVAL,
            "the database has what its anchor %.200s says: there is nothing to "
            "accept",
            anchor);
    else
        (void)snprintf(outcome, STORE_NAME_MAX + 1,
                       "anchor: change %" PRIu64 "; last: %" PRIu64,
                       a.said ? a.last.seq : a.next.seq, now->seq);
    if ((st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = row_event_add(t, &by, "accept_rollback", "", "", outcome, e)) != ST_OK)
        return st;
    return store_anchor_end(t->sql, t->vault, now, e);
}

static enum status set(struct store *s, const char *anchor, const struct anchor_end *now,
                       struct errinfo *e)
{
    struct store_txn t;
    enum status st = store_txn_begin(s, SQL_READ, &t, e);

    return st == ST_OK ? store_txn_end(&t, anchor_set(anchor, t.vault, now, false, e), e)
                       : st;
}

enum status store_accept_rollback(const char *path, const struct store_key *key,
                                  const char *actor, char outcome[STORE_NAME_MAX + 1],
                                  struct errinfo *e)
{
    struct store_key by = *key;
    struct store_anchor a;
    struct anchor_end now;
    struct store_txn t;
    struct store *s;
    enum status st;

    by.copy = true;
    if ((st = store_open(path, STORE_WRITE, &by, &s, e)) != ST_OK)
        return st;
    if ((st = store_anchor_init(&a, key, s->vaults.path, path, e)) == ST_OK &&
        (st = store_txn_begin(s, SQL_WRITE, &t, e)) == ST_OK &&
        (st = store_txn_end(&t, accept(&t, a.path, actor, outcome, &now, e), e)) == ST_OK)
        st = set(s, a.path, &now, e);
    store_anchor_free(&a);
    store_close(s);
    return st;
}
