#include "log_txn.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "log_row.h"
#include "sql_read.h"

void log_init(struct log *l)
{
    memset(l, 0, sizeof *l);
    (void)pthread_mutex_init(&l->lock, NULL);
}

void log_free(struct log *l)
{
    (void)pthread_mutex_destroy(&l->lock);
}

struct log_end log_newest(struct log *l)
{
    struct log_end now;

    (void)pthread_mutex_lock(&l->lock);
    now = l->newest;
    (void)pthread_mutex_unlock(&l->lock);
    return now;
}

/* A transaction may have seen less than this if it began before the end of another one. */
static struct log_end found(struct log *l)
{
    struct log_end at;

    (void)pthread_mutex_lock(&l->lock);
    at = l->found;
    (void)pthread_mutex_unlock(&l->lock);
    return at;
}

static void remember(struct log *l, const struct log_end *end,
                     const struct log_end *accesses)
{
    (void)pthread_mutex_lock(&l->lock);
    if (end->seq > l->newest.seq)
        l->newest = *end;
    if (accesses->seq > l->found.seq)
        l->found = *accesses;
    (void)pthread_mutex_unlock(&l->lock);
}

static bool is_same(const struct log_end *a, const struct log_end *b)
{
    return a->seq == b->seq && memcmp(a->hash, b->hash, sizeof a->hash) == 0;
}

static bool erases(const char *kind)
{
    return strcmp(kind, "delete_subject") == 0 || strcmp(kind, "delete_template") == 0;
}

/* ---- where a log ends */

/* Reads the last entry, seq 0 if there is none.  *authentic: false if one was read that is not: its MAC authenticates the log up to it.  Of a change,
 * whose fields are used, the hash is made again; that takes the entry before. */
static enum status read_last(struct log_txn *t, enum log_name log, uint32_t daemon,
                             struct log_entry *last, bool *authentic, struct errinfo *e)
{
    unsigned char hash[LOG_HASH], mac[CRYPT_HASH];
    struct log_entry before = {.seq = 0};
    struct sql_rows *r;
    bool good = true;
    const struct sql_value of = sql_int(daemon);
    enum status st =
        log == LOG_CHANGES
            ? sql_query(t->sql,
                        "SELECT " LOG_ROW_CHANGE
                        " FROM change_log ORDER BY seq DESC LIMIT 2",
                        NULL, 0, &r, e)
            : sql_query(t->sql,
                        "SELECT " LOG_ROW_ACCESS " FROM access_log WHERE daemon = $1 "
                        "ORDER BY seq DESC LIMIT 1",
                        &of, 1, &r, e);

    *last = (struct log_entry){.log = log};
    if (st == ST_OK && sql_next(r)) {
        good = log_row_read(r, log, last);
        log_mac(t->crypt, last->hash, mac);
        good = good && sodium_memcmp(mac, last->mac, sizeof mac) == 0;
        if (log == LOG_CHANGES) {
            good = good && (!sql_next(r) || log_row_read(r, log, &before));
            log_hash(before.hash, last, hash);
            good = good && memcmp(hash, last->hash, sizeof hash) == 0;
        }
    }
    if (log == LOG_CHANGES)
        good = good && last->seq != 0;
    else if (daemon == t->log->daemon) /* it has the one that the last change found */
        good = good && (last->seq > t->accesses.seq ||
                        memcmp(last->hash, t->accesses.hash, LOG_HASH) == 0);
    st = sql_done(r, st, e);
    *authentic = st != ST_OK || good; /* of what cannot be read nothing is known */
    return *authentic
               ? st
               : errinfo_set(e, ST_ECORRUPT,
                             "the last entry of the %s log is not authenticated by the "
                             "database's key, or was cut off: restore a backup",
                             log == LOG_CHANGES ? "change" : "access");
}

static void set_end(struct log_end *end, const struct log_entry *entry)
{
    end->seq = entry->seq;
    memcpy(end->hash, entry->hash, LOG_HASH);
}

static enum status need_uses(struct log_txn *t, struct errinfo *e)
{
    struct log_entry last;
    bool authentic;
    enum status st = ST_OK;

    if (t->uses.seq == 0 &&
        (st = read_last(t, LOG_ACCESSES, t->log->daemon, &last, &authentic, e)) == ST_OK)
        set_end(&t->uses, &last);
    return st;
}

/* What was read before may be the end no more. */
enum status log_txn_appends(struct log_txn *t, struct errinfo *e)
{
    if (t->appends)
        return ST_OK;
    t->appends = true;
    t->uses.seq = 0;
    return sql_lock(t->sql, LOG_LOCK_ACCESSES(t->log->daemon), e);
}

void log_txn_ahead(struct log_txn *t)
{
    (void)need_uses(t, NULL);
}

/* Each entry follows the one before, up to the end: a search for the entry itself could be led to
 * one that is no part of the log.  Another daemon may have added some since the end was read. */
enum status log_has(struct log_txn *t, const struct log_end *at, bool *has,
                    struct errinfo *e)
{
    struct log_end to = *at;
    struct log_entry entry;
    struct sql_rows *r;
    enum status st = sql_stream(
        t->sql,
        "SELECT " LOG_ROW_CHANGE
        " FROM change_log WHERE seq > $1 AND seq <= $2 ORDER BY seq",
        SQL_VALUES(sql_int((int64_t)at->seq), sql_int((int64_t)t->changes.seq)), 2, &r,
        e);

    *has = true;
    while (st == ST_OK && *has && sql_next(r)) {
        *has = log_row_read(r, LOG_CHANGES, &entry) && log_follows(t->crypt, &to, &entry);
        if (*has && erases(entry.kind))
            atomic_store(&t->log->erasure, true);
    }
    *has = *has && is_same(&to, &t->changes);
    return sql_done(r, st, e);
}

static enum status log_txn_refuse(const struct log_end *before, const char *what,
                                  struct errinfo *e)
{
    return errinfo_set(
        e, ST_EREFUSED,
        "the database is not the one that this program has used: %s change "
        "%" PRIu64,
        what, before->seq);
}

enum status log_txn_begin(struct log_txn *t, struct errinfo *e)
{
    const struct log_end *before = &t->before;
    struct log_entry last;
    bool follows = true, authentic;
    enum status st;

    t->known = t->unlogged = false;
    st = read_last(t, LOG_CHANGES, 0, &last, &authentic, e);
    set_end(&t->changes, &last);
    t->accesses = last.daemon == t->log->daemon ? last.accesses : found(t->log);
    memcpy(t->wrapped, last.digest, sizeof t->wrapped);
    if (st != ST_OK)
        return !authentic && before->seq != 0
                   ? log_txn_refuse(before, "its log has no good end after", e)
                   : st;
    if (t->appends && (st = need_uses(t, e)) != ST_OK)
        return st;
    if (is_same(&t->changes, before))
        return ST_OK;
    if (before->seq != 0) {
        if (t->changes.seq < before->seq)
            return log_txn_refuse(before, "it is an older one, without", e);
        if ((st = log_has(t, before, &follows, e)) != ST_OK)
            return st;
        if (!follows)
            return log_txn_refuse(before, "its log is another one from", e);
    }
    remember(t->log, &t->changes, &t->accesses);
    return ST_OK;
}

void log_txn_create(struct log_txn *t)
{
    memset(&t->changes, 0, sizeof t->changes);
    memset(&t->accesses, 0, sizeof t->accesses);
    memset(t->digest, 0, sizeof t->digest);
    t->known = true;
    t->unlogged = false;
}

enum status log_txn_check(const struct log_txn *t, struct errinfo *e)
{
    return !t->unlogged ? ST_OK
                        : errinfo_set(e, ST_EINTERNAL, "a change without an entry");
}

void log_txn_prove(struct log_txn *t)
{
    const bool change = t->added == LOG_CHANGES;
    const struct log_end *end = change ? &t->changes : &t->uses;
    const struct sql_value v[] = {sql_int((int64_t)end->seq),
                                  sql_blob(end->hash, LOG_HASH), sql_int(t->log->daemon)};

    if (t->added != LOGS)
        sql_prove(t->sql,
                  change ? "SELECT 1 FROM change_log WHERE seq = $1 AND hash = $2"
                         : "SELECT 1 FROM access_log WHERE daemon = $3 AND seq = $1 "
                           "AND hash = $2",
                  v, change ? 2 : 3);
}

void log_txn_committed(struct log_txn *t)
{
    remember(t->log, &t->changes, &t->accesses);
}

/* ---- the digest */

static const char label[16] = "surface digest";

static void name_of(uint64_t seq, unsigned char out[16])
{
    memset(out, 0, 16);
    bytes_set(out, seq, 8);
}

static enum status need_digest(struct log_txn *t, struct errinfo *e)
{
    unsigned char name[16];

    name_of(t->changes.seq, name);
    t->known = t->known || crypt_unwrap(t->crypt, label, name, t->wrapped, t->digest);
    return t->known ? ST_OK
                    : errinfo_set(e, ST_ECORRUPT,
                                  "the digest of change %" PRIu64 " is damaged",
                                  t->changes.seq);
}

void log_txn_sum(const struct crypt *c, const unsigned char *minus,
                 const unsigned char *plus, unsigned char sum[LOG_DIGEST])
{
    unsigned char one[LOG_DIGEST]; /* little-endian, modulo 2^256 */

    if (minus != NULL) {
        crypt_lookup(c, "row", minus, CRYPT_HASH, one);
        sodium_sub(sum, one, sizeof one);
    }
    if (plus != NULL) {
        crypt_lookup(c, "row", plus, CRYPT_HASH, one);
        sodium_add(sum, one, sizeof one);
    }
}

enum status log_txn_count(struct log_txn *t, const unsigned char *minus,
                          const unsigned char *plus, struct errinfo *e)
{
    const enum status st = need_digest(t, e);

    if (st != ST_OK)
        return st;
    log_txn_sum(t->crypt, minus, plus, t->digest);
    t->unlogged = true;
    return ST_OK;
}

enum status log_txn_agrees(struct log_txn *t, const unsigned char sum[LOG_DIGEST],
                           bool *same, struct errinfo *e)
{
    const enum status st = need_digest(t, e);

    *same = st == ST_OK && sodium_memcmp(sum, t->digest, LOG_DIGEST) == 0;
    return st;
}

void log_txn_accept(struct log_txn *t, const unsigned char sum[LOG_DIGEST])
{
    memcpy(t->digest, sum, LOG_DIGEST);
    t->known = t->unlogged = true;
}

/* ---- entries */

/* The entry after `end`, which becomes the end. */
static enum status append(struct log_txn *t, struct log_entry *entry, const char *kind,
                          const unsigned char *uid, const char *object,
                          const char *outcome, struct log_end *end, struct errinfo *e)
{
    enum status st;

    entry->seq = end->seq + 1;
    memcpy(entry->at, t->by.at, sizeof entry->at);
    (void)snprintf(entry->kind, sizeof entry->kind, "%s", kind);
    (void)snprintf(entry->actor, sizeof entry->actor, "%s", t->by.actor);
    if (uid != NULL)
        memcpy(entry->uid, uid, sizeof entry->uid);
    (void)snprintf(entry->object, sizeof entry->object, "%s", object);
    (void)snprintf(entry->outcome, sizeof entry->outcome, "%s", outcome);
    log_hash(end->hash, entry, entry->hash);
    log_mac(t->crypt, entry->hash, entry->mac);
    if (entry->log == LOG_CHANGES &&
        (strcmp(kind, LOG_CHECKPOINT) == 0 || strcmp(kind, LOG_EXPORT) == 0))
        log_sign(t->crypt, entry, "");
    if ((st = log_row_add(t->sql, entry, e)) == ST_OK) {
        set_end(end, entry);
        t->added = entry->log;
    }
    return st;
}

/* *entry names the end of a daemon's accesses. */
static enum status change(struct log_txn *t, struct log_entry *entry, const char *kind,
                          const unsigned char *uid, const char *object,
                          const char *outcome, struct errinfo *e)
{
    unsigned char name[16];
    enum status st = need_digest(t, e);

    if (st != ST_OK)
        return st;
    name_of(t->changes.seq + 1, name);
    crypt_wrap(t->crypt, label, name, t->digest, entry->digest);
    if ((st = append(t, entry, kind, uid, object, outcome, &t->changes, e)) == ST_OK)
        t->unlogged = false;
    return st;
}

enum status log_change(struct log_txn *t, const char *kind, const unsigned char *uid,
                       const char *object, const char *outcome, struct errinfo *e)
{
    struct log_entry entry = {.log = LOG_CHANGES, .daemon = t->log->daemon};
    enum status st = need_uses(t, e);

    if (st != ST_OK)
        return st;
    entry.accesses = t->uses;
    if ((st = change(t, &entry, kind, uid, object, outcome, e)) == ST_OK)
        t->accesses = entry.accesses;
    return st;
}

/* The last change that names an end of this daemon's. */
static enum status read_bound(struct log_txn *t, uint32_t daemon, uint64_t *seq,
                              struct errinfo *e)
{
    struct sql_rows *r;
    enum status st = SQL_FIRST(t->sql, &r, e,
                               "SELECT access_seq FROM change_log WHERE daemon = $1 "
                               "ORDER BY seq DESC LIMIT 1",
                               sql_int(daemon));

    *seq = st == ST_OK ? (uint64_t)sql_column(r, 0).i : 0;
    return sql_done(r, st == ST_ENOTFOUND ? ST_OK : st, e);
}

enum status log_found(struct log_txn *t, uint32_t daemon, uint64_t *to, struct errinfo *e)
{
    struct log_entry entry = {.log = LOG_CHANGES, .daemon = daemon}, last;
    bool authentic;
    enum status st;

    *to = 0;
    if (daemon == t->log->daemon)
        return ST_OK; /* any change of its own names it */
    if ((st = read_last(t, LOG_ACCESSES, daemon, &last, &authentic, e)) != ST_OK ||
        (st = read_bound(t, daemon, to, e)) != ST_OK || last.seq <= *to)
        return st;
    *to = last.seq;
    set_end(&entry.accesses, &last);
    return change(t, &entry, LOG_FOUND, NULL, "", "", e);
}

enum status log_access(struct log_txn *t, const char *kind, const unsigned char *uid,
                       const char *object, const char *outcome, struct errinfo *e)
{
    struct log_entry entry = {.log = LOG_ACCESSES, .daemon = t->log->daemon};
    enum status st = log_txn_appends(t, e);

    if (st != ST_OK || (st = need_uses(t, e)) != ST_OK)
        return st;
    return append(t, &entry, kind, uid, object, outcome, &t->uses, e);
}
