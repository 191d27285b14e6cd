#include "store_anchor.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "row_end.h"

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

enum status store_anchor_end(struct sql_txn *t, const struct vault *v,
                             struct anchor_end *end, struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    struct errinfo why;
    enum status st = row_end_read(t, v, STORE_CHAIN_CHANGES, &end->seq, end->hash, e);

    if (st != ST_OK)
        return st;
    st = row_end_read(t, v, STORE_CHAIN_USES, &end->uses, hash, &why);
    if (st == ST_ECORRUPT) /* which stops nothing: verifications go on without it */
        end->uses = 0;
    else if (st != ST_OK)
        return errinfo_set(e, st, "%s", why.msg);
    return ST_OK;
}

/* Does the chain of changes, which ends with end, have what was said? */
static enum status has(struct sql_txn *t, const struct anchor_end *end,
                       const struct anchor_end *said, bool *yes, struct errinfo *e)
{
    *yes = false;
    if (said->seq > end->seq)
        return ST_OK;
    if (said->seq == end->seq) { /* which has a MAC */
        *yes = memcmp(said->hash, end->hash, sizeof end->hash) == 0;
        return ST_OK;
    }
    return row_end_has(t, STORE_CHAIN_CHANGES, said->seq, said->hash, yes, e);
}

/* *next: it has what was announced. */
static enum status hold(struct sql_txn *t, const struct vault *v,
                        const struct anchor *said, struct anchor_end *end, bool *last,
                        bool *next, struct errinfo *e)
{
    enum status st = store_anchor_end(t, v, end, e);

    *last = *next = false;
    if (st == ST_OK && said->said)
        st = has(t, end, &said->last, last, e);
    if (st == ST_OK && said->announced)
        st = has(t, end, &said->next, next, e);
    return st;
}

enum status store_anchor_agrees(struct sql_txn *t, const struct vault *v,
                                const struct anchor *said, struct anchor_end *end,
                                bool *yes, struct errinfo *e)
{
    bool last, next;
    const enum status st = hold(t, v, said, end, &last, &next, e);

    *yes = last || next;
    return st;
}

static enum status older(const struct store_anchor *a, const char *db,
                         const struct anchor *anchor, const struct anchor_end *end,
                         struct errinfo *e)
{
    const uint64_t said = anchor->said ? anchor->last.seq : anchor->next.seq;

    if (said > end->seq)
        return errinfo_set(
            e, ST_EREFUSED,
            "%.120s is older than its anchor %.120s, which has change %" PRIu64
            ": the last one here is %" PRIu64
            ".  Restore the newest backup; if it was put back on purpose: "
            "surfacectl accept-rollback",
            db, a->path, said, end->seq);
    return errinfo_set(e, ST_EREFUSED,
                       "%.120s does not have change %" PRIu64
                       " of its anchor %.120s, but "
                       "another one.  Restore the newest backup; if it was put back on "
                       "purpose: surfacectl accept-rollback",
                       db, said, a->path);
}

/* Why the anchor cannot be read, and what to do. */
static enum status unread(const struct store_anchor *a, const char *db, enum status st,
                          const struct errinfo *why, struct errinfo *e)
{
    static const char todo[] = "Bring it back from where it was kept, or name it with "
                               "--anchor; if it is lost: surfacectl accept-rollback";

    if (st == ST_ENOTFOUND)
        return errinfo_set(e, ST_EREFUSED,
                           "the anchor of %.120s is missing: there is no %.120s.  %s", db,
                           a->path, todo);
    if (st == ST_EREFUSED)
        return errinfo_set(e, st, "%.250s.  %s", why->msg, todo);
    return errinfo_set(e, st, "%s", why->msg);
}

enum status store_anchor_ask(const struct store_anchor *a, const struct vault *v,
                             const char *db, struct anchor *said, struct errinfo *e)
{
    struct errinfo why;
    const enum status st = anchor_read(a->path, v, said, &why);

    return st == ST_OK ? st : unread(a, db, st, &why, e);
}

enum status store_anchor_check(const struct store_anchor *a, struct sql_txn *t,
                               const struct vault *v, const char *db,
                               const struct anchor *said, bool settle, struct errinfo *e)
{
    struct anchor_end end;
    bool last, next;
    const enum status st = hold(t, v, said, &end, &last, &next, e);

    if (st != ST_OK)
        return st;
    if (!last && !next)
        return older(a, db, said, &end, e);
    if (settle && said->announced)
        return anchor_set(a->path, v, next ? &said->next : &said->last, said->served, e);
    return ST_OK;
}

/* ---- told */

void store_anchor_tell(struct store_anchor *a, const struct vault *v,
                       const struct anchor_end *end)
{
    struct errinfo why;
    enum status st;

    if (a->path == NULL || end->seq <= atomic_load(&a->seq))
        return;
    /* Where it was deleted under the running store, that knows what it said. */
    if ((st = anchor_advance(a->path, v, end, &why)) == ST_ENOTFOUND)
        st = anchor_set(a->path, v, end, a->serving >= 0, &why);
    if (st == ST_OK) {
        atomic_store(&a->seq, end->seq);
    } else if (!atomic_flag_test_and_set(&a->failed)) {
        a->why = why;
        atomic_store(&a->fault, true);
    }
}
