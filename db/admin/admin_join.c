#include "admin_join.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "errinfo.h"
#include "log_anchor.h"
#include "log_row.h"
#include "newfile.h"
#include "store_open.h"
#include "store_txn.h"

static enum status admin_join_check(const char *path, const struct store_key *key,
                                    struct errinfo *e)
{
    struct store_server is;
    enum status st;

    if (!store_on_server(path))
        return errinfo_set(e, ST_EINVAL,
                           "a database in a file has one daemon: nothing joins it");
    if (key->anchor == NULL)
        return errinfo_set(e, ST_EINVAL,
                           "name the file that will be the daemon's anchor (--anchor)");
    if (!newfile_missing(key->anchor))
        return errinfo_set(e, ST_EEXISTS,
                           "there is an anchor %.160s: its daemon has joined already",
                           key->anchor);
    if ((st = store_server(path, &is, e)) != ST_OK)
        return st;
    if (is.ahead_ms > STORE_CLOCKS_MS || is.ahead_ms < -STORE_CLOCKS_MS)
        return errinfo_set(e, ST_EINVAL,
                           "the server's clock is %lld ms ahead of this machine's: set "
                           "both by one source (chrony)",
                           (long long)is.ahead_ms);
    return ST_OK;
}

/* The first entry of its kind would have to be forged to give a number twice. */
static enum status find_number(struct log_txn *t, uint32_t *out, struct errinfo *e)
{
    const struct log_end beginning = {.seq = 0};
    struct log_entry *list = NULL;
    bool whole = false;
    size_t n = 0;
    enum status st;

    if ((st = log_has(t, &beginning, &whole, e)) != ST_OK)
        return st;
    if (!whole)
        return errinfo_set(e, ST_EREFUSED,
                           "the change log is not as it was written: surfacectl audit "
                           "verify says where");
    st = log_list(t->sql, LOG_JOIN, 0, &list, &n, e);
    free(list);
    *out = (uint32_t)n + 1;
    if (st == ST_OK && n >= LOG_DAEMONS - 1)
        st = errinfo_set(e, ST_EFULL,
                         "%d daemons have joined: give this one the anchor of one that "
                         "is gone",
                         LOG_DAEMONS - 1);
    return st;
}

static enum status admin_join_join(struct log_txn *t, uint32_t *out, struct errinfo *e)
{
    char outcome[LOG_TEXT + 1];
    enum status st = find_number(t, out, e);

    if (st != ST_OK)
        return st;
    t->log->daemon = *out;
    t->accesses = t->uses = (struct log_end){.seq = 0}; /* its log is empty */
    (void)snprintf(outcome, sizeof outcome, "daemon %" PRIu32, *out);
    return log_change(t, LOG_JOIN, NULL, "", outcome, e);
}

/* Commits t, with an anchor that is on the disk before. */
static enum status commit(struct store *s, struct log_txn *t, const char *anchor,
                          uint32_t daemon, struct errinfo *e)
{
    const struct log_anchor at = {.daemon = daemon, .end = t->changes};
    struct newfile n = NEWFILE_NONE;
    char what[40];
    const enum status st = log_anchor_prepare(anchor, s->crypt, &at, &n, e);

    if (st != ST_OK) {
        (void)store_end(s, t, st, NULL);
        newfile_close(&n);
        return st;
    }
    (void)snprintf(what, sizeof what, "daemon %" PRIu32 " has joined", daemon);
    return store_commit(s, t, &n, what, e);
}

/* A call that was interrupted behind its commit has left the anchor as a part.  *daemon: its number.
 * ST_EREFUSED: there is no such part. */
static enum status admin_join_complete(const char *path, const struct store_key *key,
                                       uint32_t *daemon, struct errinfo *e)
{
    struct store *s;
    const enum status st = store_open(path, STORE_WRITE, key, &s, e);

    if (st != ST_OK)
        return st;
    *daemon = s->log.daemon;
    store_close(s);
    return ST_OK;
}

enum status admin_join(const char *path, const struct store_key *key, const char *actor,
                       uint32_t *daemon, struct errinfo *e)
{
    struct store_key by_key = *key;
    struct log_txn t;
    struct store *s;
    enum status st;

    *daemon = 0;
    by_key.anchor = NULL; /* there is none yet */
    if ((st = admin_join_check(path, key, e)) != ST_OK ||
        (st = admin_join_complete(path, key, daemon, e)) != ST_EREFUSED ||
        (st = store_open(path, STORE_WRITE, &by_key, &s, e)) != ST_OK)
        return st;
    if ((st = store_act_begin(s, actor, SQL_WRITE, &t, e)) == ST_OK) {
        if ((st = admin_join_join(&t, daemon, e)) == ST_OK)
            st = commit(s, &t, key->anchor, *daemon, e);
        else
            (void)store_end(s, &t, st, NULL);
    }
    store_close(s);
    return st;
}
