#include "store_anchor.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "row_event.h"
#include "store_txn.h"

/* ---- its place */

static bool folder_writable(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *dir = slash == NULL ? strdup(".") : strndup(path, (size_t)(slash - path) + 1);
    const bool can = dir != NULL && access(dir, W_OK | X_OK) == 0;

    free(dir);
    return can;
}

/* A folder that the service manager makes for each run. */
static bool is_credential(const char *path)
{
    static const char usual[] = "/run/credentials/";
    const char *dir = getenv("CREDENTIALS_DIRECTORY");

    return strncmp(path, usual, strlen(usual)) == 0 ||
           (dir != NULL && dir[0] != '\0' && strncmp(path, dir, strlen(dir)) == 0 &&
            path[strlen(dir)] == '/');
}

static char *join(const char *path, const char *suffix)
{
    const size_t n = strlen(path) + strlen(suffix) + 1;
    char *out = malloc(n);

    if (out != NULL)
        (void)snprintf(out, n, "%s%s", path, suffix);
    return out;
}

enum status store_anchor_init(struct store_anchor *a, const struct store_key *key,
                              const char *path, const char *db, struct errinfo *e)
{
    char *by_key, *by_db;

    memset(a, 0, sizeof *a);
    a->serving = -1;
    if (key->copy)
        return ST_OK;
    by_key = key->anchor != NULL ? strdup(key->anchor) : join(path, ".anchor");
    by_db = key->anchor != NULL ? strdup(key->anchor) : join(db, ".key.anchor");
    if (by_key == NULL || by_db == NULL) {
        free(by_key);
        free(by_db);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    if (access(by_key, F_OK) != 0 &&
        (access(by_db, F_OK) == 0 || is_credential(path) || !folder_writable(by_key))) {
        a->path = by_db;
        free(by_key);
    } else {
        a->path = by_key;
        free(by_db);
    }
    return ST_OK;
}

void store_anchor_free(struct store_anchor *a)
{
    if (a->serving >= 0)
        (void)close(a->serving);
    free(a->path);
}

/* ---- asked */

enum status store_anchor_end(struct store_txn *t, struct anchor_end *end,
                             struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    struct errinfo why;
    enum status st = row_event_end(t, STORE_CHAIN_CHANGES, &end->seq, end->hash, e);

    if (st != ST_OK)
        return st;
    st = row_event_end(t, STORE_CHAIN_USES, &end->uses, hash, &why);
    if (st == ST_ECORRUPT) /* which stops nothing: verifications go on without it */
        end->uses = 0;
    else if (st != ST_OK)
        return errinfo_set(e, st, "%s", why.msg);
    return ST_OK;
}

/* Does the chain of changes, which ends with end, have what was said? */
static enum status has(struct store_txn *t, const struct anchor_end *end,
                       const struct anchor_end *said, bool *yes, struct errinfo *e)
{
    *yes = false;
    if (said->seq > end->seq)
        return ST_OK;
    if (said->seq == end->seq) { /* which has a MAC */
        *yes = memcmp(said->hash, end->hash, sizeof end->hash) == 0;
        return ST_OK;
    }
    return row_event_has(t, STORE_CHAIN_CHANGES, said->seq, said->hash, yes, e);
}

static enum status older(const struct store_txn *t, const struct anchor *a,
                         const struct anchor_end *end, struct errinfo *e)
{
    const uint64_t said = a->said ? a->last.seq : a->next.seq;

    if (said > end->seq)
        return errinfo_set(
            e, ST_EREFUSED,
            "%.120s is older than its anchor %.120s, which has change %" PRIu64
            ": the last one here is %" PRIu64
            ".  Restore the newest backup; if it was put back on purpose: "
            "surfacectl accept-rollback",
            t->store->path, t->store->anchor.path, said, end->seq);
    return errinfo_set(e, ST_EREFUSED,
                       "%.120s does not have change %" PRIu64
                       " of its anchor %.120s, but "
                       "another one.  Restore the newest backup; if it was put back on "
                       "purpose: surfacectl accept-rollback",
                       t->store->path, said, t->store->anchor.path);
}

/* Why the anchor cannot be read, and what to do. */
static enum status unread(const struct store_txn *t, enum status st,
                          const struct errinfo *why, struct errinfo *e)
{
    static const char todo[] = "Bring it back from where it was kept, or name it with "
                               "--anchor; if it is lost: surfacectl accept-rollback";

    if (st == ST_ENOTFOUND)
        return errinfo_set(e, ST_EREFUSED,
                           "the anchor of %.120s is missing: there is no %.120s.  %s",
                           t->store->path, t->store->anchor.path, todo);
    if (st == ST_EREFUSED)
        return errinfo_set(e, st, "%.250s.  %s", why->msg, todo);
    return errinfo_set(e, st, "%s", why->msg);
}

/* *next: it has what was announced. */
static enum status hold(struct store_txn *t, const struct anchor *a,
                        struct anchor_end *end, bool *last, bool *next, struct errinfo *e)
{
    enum status st = store_anchor_end(t, end, e);

    *last = *next = false;
    if (st == ST_OK && a->said)
        st = has(t, end, &a->last, last, e);
    if (st == ST_OK && a->announced)
        st = has(t, end, &a->next, next, e);
    return st;
}

enum status store_anchor_agrees(struct store_txn *t, const struct anchor *a,
                                struct anchor_end *end, bool *yes, struct errinfo *e)
{
    bool last, next;
    const enum status st = hold(t, a, end, &last, &next, e);

    *yes = last || next;
    return st;
}

enum status store_anchor_check(struct store_txn *t, bool settle, struct errinfo *e)
{
    struct store_anchor *s = &t->store->anchor;
    struct anchor_end end;
    struct anchor a;
    struct errinfo why;
    bool last, next;
    enum status st;

    if (s->path == NULL)
        return ST_OK;
    if ((st = anchor_read(s->path, t->vault, &a, &why)) != ST_OK)
        return unread(t, st, &why, e);
    if ((st = hold(t, &a, &end, &last, &next, e)) != ST_OK)
        return st;
    if (!last && !next)
        return older(t, &a, &end, e);
    if (settle && a.announced)
        return anchor_set(s->path, t->vault, next ? &a.next : &a.last, a.served, e);
    return ST_OK;
}

/* ---- told */

enum status store_anchor_mark(struct store *s, bool served, struct errinfo *e)
{
    const struct store_anchor *a = &s->anchor;
    struct anchor_end now;
    struct store_txn t;
    enum status st;

    if (a->serving < 0)
        return ST_OK;
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = store_anchor_end(&t, &now, e)) == ST_OK)
        st = anchor_mark(a->path, t.vault, &now,
                         served || !anchor_serves_alone(a->serving), e);
    return store_txn_end(&t, st, e);
}

/* It was deleted under the running store, which knows what it said. */
static enum status make_again(struct store_txn *t, const struct anchor_end *end,
                              struct errinfo *e)
{
    const struct store_anchor *a = &t->store->anchor;

    return anchor_set(a->path, t->vault, end, a->serving >= 0, e);
}

void store_anchor_tell(struct store_txn *t, const struct anchor_end *end)
{
    struct store_anchor *a = &t->store->anchor;
    struct errinfo why;
    enum status st;

    if (a->path == NULL || end->seq <= atomic_load(&a->seq))
        return;
    if ((st = anchor_advance(a->path, t->vault, end, &why)) == ST_ENOTFOUND)
        st = make_again(t, end, &why);
    if (st == ST_OK) {
        atomic_store(&a->seq, end->seq);
    } else if (!atomic_flag_test_and_set(&a->failed)) {
        a->why = why;
        atomic_store(&a->fault, true);
    }
}
