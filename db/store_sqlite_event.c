#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_chain.h"
#include "store_sqlite.h"

static enum status read_end(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                            uint64_t *seq, unsigned char hash[STORE_CHAIN_HASH])
{
    unsigned char mac[STORE_CHAIN_HASH], wanted[STORE_CHAIN_HASH];

    if (!store_sqlite_bytes(stmt, 1, hash, STORE_CHAIN_HASH) ||
        !store_sqlite_bytes(stmt, 2, mac, sizeof mac))
        return ST_ECORRUPT;
    *seq = (uint64_t)sqlite3_column_int64(stmt, 0);
    store_chain_end(c->vault, *seq, hash, wanted);
    return sodium_memcmp(mac, wanted, sizeof mac) == 0 ? ST_OK : ST_ECORRUPT;
}

enum status store_sqlite_event_end(struct store_sqlite_conn *c, uint64_t *seq,
                                   unsigned char hash[STORE_CHAIN_HASH],
                                   struct errinfo *e)
{
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_EVENT_END, &stmt, e);
    int rc;

    *seq = 0;
    memset(hash, 0, STORE_CHAIN_HASH);
    if (st != ST_OK)
        return st;
    if ((rc = sqlite3_step(stmt)) == SQLITE_DONE)
        st = errinfo_set(e, ST_ECORRUPT, "the end of the audit log is missing");
    else if (rc != SQLITE_ROW)
        st = store_sqlite_fail(c, "cannot read the events", e);
    else if ((st = read_end(c, stmt, seq, hash)) != ST_OK)
        (void)errinfo_set(e, st, "the end of the audit log is not what was written");
    (void)sqlite3_reset(stmt);
    return st;
}

static enum status set_end(struct store_sqlite_conn *c, uint64_t seq,
                           const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    unsigned char mac[STORE_CHAIN_HASH];
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_EVENT_SET_END, &stmt, e);

    if (st != ST_OK)
        return st;
    store_chain_end(c->vault, seq, hash, mac);
    if (sqlite3_bind_int64(stmt, 1, (sqlite3_int64)seq) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 2, hash, STORE_CHAIN_HASH) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 3, mac, sizeof mac) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot add an event", e);
    return store_sqlite_run(c, stmt, e);
}

enum status store_sqlite_event_begin(struct store_sqlite_conn *c, struct errinfo *e)
{
    static const unsigned char start[STORE_CHAIN_HASH];

    return set_end(c, 0, start, e);
}

static enum status add_mark(struct store_sqlite_conn *c, uint64_t seq, const char *at,
                            const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    struct store_chain_mark m = {.seq = seq};
    sqlite3_stmt *stmt;
    enum status st = store_sqlite_prepare(c, SQL_MARK_ADD, &stmt, e);

    if (st != ST_OK)
        return st;
    (void)snprintf(m.at, sizeof m.at, "%s", at);
    memcpy(m.hash, hash, sizeof m.hash);
    store_chain_sign(c->vault, &m);
    if (sqlite3_bind_int64(stmt, 1, (sqlite3_int64)seq) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, m.at) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 3, m.hash, sizeof m.hash) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 4, m.signature, sizeof m.signature) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot sign the audit log", e);
    return store_sqlite_run(c, stmt, e);
}

enum status store_sqlite_event_add(struct store_sqlite_conn *c,
                                   const struct store_act *by, const char *kind,
                                   const char *subject, const char *template_id,
                                   const char *outcome, struct errinfo *e)
{
    unsigned char ref[STORE_SEAL_REF], hash[STORE_CHAIN_HASH];
    struct store_chain_entry entry = {.at = by->at,
                                      .kind = kind,
                                      .actor = by->actor,
                                      .subject = ref,
                                      .template_id = template_id,
                                      .outcome = outcome};
    sqlite3_stmt *stmt;
    enum status st;

    if ((st = store_sqlite_event_end(c, &entry.seq, hash, e)) != ST_OK ||
        (st = store_sqlite_prepare(c, SQL_EVENT_ADD, &stmt, e)) != ST_OK)
        return st;
    entry.seq++;
    if (subject[0] != '\0') {
        store_seal_ref(c->vault, subject, ref);
        entry.nsubject = sizeof ref;
    }
    store_chain_next(hash, &entry, hash);
    if (sqlite3_bind_int64(stmt, 1, (sqlite3_int64)entry.seq) != SQLITE_OK ||
        store_sqlite_bind(stmt, 2, by->at) != SQLITE_OK ||
        store_sqlite_bind(stmt, 3, kind) != SQLITE_OK ||
        store_sqlite_bind(stmt, 4, by->actor) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 5, ref, entry.nsubject) != SQLITE_OK ||
        store_sqlite_bind(stmt, 6, template_id) != SQLITE_OK ||
        store_sqlite_bind(stmt, 7, outcome) != SQLITE_OK ||
        store_sqlite_bind_bytes(stmt, 8, hash, sizeof hash) != SQLITE_OK)
        return store_sqlite_fail(c, "cannot add an event", e);
    if ((st = store_sqlite_run(c, stmt, e)) != ST_OK ||
        (st = set_end(c, entry.seq, hash, e)) != ST_OK ||
        !store_chain_due(entry.seq, kind))
        return st;
    return add_mark(c, entry.seq, by->at, hash, e);
}

enum status store_sqlite_event(struct store *s, const struct store_act *by,
                               const char *kind, const char *subject,
                               const char *template_id, const char *outcome,
                               struct errinfo *e)
{
    struct store_sqlite_conn *c;
    enum status st;

    if ((st = store_sqlite_write(s, false, &c, e)) != ST_OK)
        return st;
    st = store_sqlite_event_add(c, by, kind, subject, template_id, outcome, e);
    return store_sqlite_written(s, st, e);
}
