#include "row_event.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_column.h"
#include "store_rules.h"
#include "row_crypt.h"
#include "row_end.h"
#include "store_txn.h"

const unsigned char row_event_uses[STORE_CHAIN_OBJECT] = "uses";

enum status row_event_end(struct store_txn *t, enum store_chain chain, uint64_t *seq,
                          unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    return row_end_read(t->sql, t->vault, chain, seq, hash, e);
}

enum status row_event_has(struct store_txn *t, enum store_chain chain, uint64_t seq,
                          const unsigned char hash[STORE_CHAIN_HASH], bool *has,
                          struct errinfo *e)
{
    return row_end_has(t->sql, chain, seq, hash, has, e);
}

static enum status set_end(struct store_txn *t, enum store_chain chain, uint64_t seq,
                           const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    unsigned char mac[STORE_CHAIN_HASH];

    store_chain_end(t->vault, chain, seq, hash, mac);
    return SQL_RUN(t->sql, e,
                   "INSERT INTO events_end (chain, seq, hash, mac) "
                   "VALUES ($1, $2, $3, $4) ON CONFLICT (chain) DO UPDATE "
                   "SET seq = excluded.seq, hash = excluded.hash, mac = excluded.mac",
                   sql_int(chain), sql_int((int64_t)seq),
                   sql_blob(hash, STORE_CHAIN_HASH), sql_blob(mac, sizeof mac));
}

enum status row_event_begin(struct store_txn *t, struct errinfo *e)
{
    static const unsigned char start[STORE_CHAIN_HASH];
    const enum status st = set_end(t, STORE_CHAIN_CHANGES, 0, start, e);

    return st == ST_OK ? set_end(t, STORE_CHAIN_USES, 0, start, e) : st;
}

/* ---- adding */

static const unsigned char none[1];

static enum status add_mark(struct store_txn *t, const struct store_chain_entry *entry,
                            const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    struct store_chain_mark m = {.chain = entry->chain, .seq = entry->seq};

    (void)snprintf(m.at, sizeof m.at, "%s", entry->at);
    memcpy(m.hash, hash, sizeof m.hash);
    store_chain_sign(t->vault, &m);
    return SQL_RUN(t->sql, e,
                   "INSERT INTO checkpoints (chain, seq, at, hash, signature) "
                   "VALUES ($1, $2, $3, $4, $5)",
                   sql_int(m.chain), sql_int((int64_t)m.seq), sql_text(m.at),
                   sql_blob(m.hash, sizeof m.hash),
                   sql_blob(m.signature, sizeof m.signature));
}

static enum status insert(struct store_txn *t, const struct store_chain_entry *entry,
                          const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    return SQL_RUN(
        t->sql, e,
        "INSERT INTO events (chain, seq, at, kind, actor, subject, template_id, outcome, "
        "object, row_mac, uses, uses_hash, hash) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13)",
        sql_int(entry->chain), sql_int((int64_t)entry->seq), sql_text(entry->at),
        sql_text(entry->kind), sql_text(entry->actor),
        sql_blob(entry->subject, entry->nsubject), sql_text(entry->template_id),
        sql_text(entry->outcome), sql_blob(entry->object, entry->nobject),
        sql_blob(entry->row, entry->nrow), sql_int((int64_t)entry->uses),
        sql_blob(entry->uses_hash, entry->nuses_hash), sql_blob(hash, STORE_CHAIN_HASH));
}

/* The entry with its number, after the one that its chain's end names. */
static enum status append(struct store_txn *t, struct store_chain_entry *entry,
                          const char *subject, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF], hash[STORE_CHAIN_HASH];
    enum status st = row_event_end(t, entry->chain, &entry->seq, hash, e);

    if (st != ST_OK)
        return st;
    entry->seq++;
    if (subject[0] != '\0') {
        row_crypt_ref(t->vault, subject, ref);
        entry->subject = ref;
        entry->nsubject = sizeof ref;
    }
    store_chain_next(hash, entry, hash);
    st = insert(t, entry, hash, e);
    if (st == ST_OK)
        st = set_end(t, entry->chain, entry->seq, hash, e);
    if (st == ST_OK && store_chain_due(entry->seq, entry->kind))
        st = add_mark(t, entry, hash, e);
    if (st == ST_OK && entry->chain == STORE_CHAIN_CHANGES)
        t->made = entry->seq;
    return st;
}

enum status row_event_leave(struct store_txn *t, const struct store_act *by,
                            const char *kind, const char *subject,
                            const char *template_id, const char *outcome,
                            const struct row_event_row *left, struct errinfo *e)
{
    unsigned char uses_hash[STORE_CHAIN_HASH];
    struct store_chain_entry entry = {
        .chain = STORE_CHAIN_CHANGES,
        .at = by->at,
        .kind = kind,
        .actor = by->actor,
        .subject = left != NULL && left->ref != NULL ? left->ref : none,
        .nsubject = left != NULL && left->ref != NULL ? ROW_CRYPT_REF : 0,
        .template_id = template_id,
        .outcome = outcome,
        .object = left != NULL ? left->object : none,
        .nobject = left != NULL ? sizeof left->object : 0,
        .row = left != NULL ? left->mac : none,
        .nrow = left != NULL && !left->gone ? sizeof left->mac : 0,
        .uses_hash = uses_hash,
        .nuses_hash = sizeof uses_hash,
    };
    const enum status st = row_event_end(t, STORE_CHAIN_USES, &entry.uses, uses_hash, e);

    return st == ST_OK ? append(t, &entry, subject, e) : st;
}

enum status row_event_add(struct store_txn *t, const struct store_act *by,
                          const char *kind, const char *subject, const char *template_id,
                          const char *outcome, struct errinfo *e)
{
    return row_event_leave(t, by, kind, subject, template_id, outcome, NULL, e);
}

enum status row_event_use(struct store_txn *t, const struct store_act *by,
                          const char *kind, const char *subject, const char *template_id,
                          const char *outcome, struct errinfo *e)
{
    struct store_chain_entry entry = {.chain = STORE_CHAIN_USES,
                                      .at = by->at,
                                      .kind = kind,
                                      .actor = by->actor,
                                      .subject = none,
                                      .template_id = template_id,
                                      .outcome = outcome,
                                      .object = none,
                                      .row = none,
                                      .uses_hash = none};

    return append(t, &entry, subject, e);
}

enum status row_event_signs(struct store_txn *t, const struct store_act *by,
                            const char *kind, const struct vault *v, const char *outcome,
                            struct errinfo *e)
{
    struct row_event_row key = {.gone = false};

    memcpy(key.object, store_chain_key, sizeof key.object);
    vault_public(v, key.mac);
    return row_event_leave(t, by, kind, "", "", outcome, &key, e);
}

enum status row_event_renew(struct store_txn *t, const struct vault *next,
                            struct errinfo *e)
{
    unsigned char hash[STORE_CHAIN_HASH];
    struct store_txn by_next = *t;
    enum status st = ST_OK;
    uint64_t seq;

    by_next.vault = next;
    for (int i = 0; i < STORE_CHAINS && st == ST_OK; i++) {
        const enum store_chain chain = (enum store_chain)i;

        if ((st = row_event_end(t, chain, &seq, hash, e)) == ST_OK)
            st = set_end(&by_next, chain, seq, hash, e);
    }
    return st;
}

/* ---- rows */

/* Is this, entry seq or 0, what a store that serves knows of the row?  What it knows does not have
 * what this transaction has made, and may be later than what was asked for. */
static bool is_known(struct store_txn *t, uint64_t seq, const struct row_event_row *row,
                     uint64_t asked)
{
    static const unsigned char gone[STORE_LATEST_ROW];
    struct store_latest_slot known;

    if (!store_latest_find(&t->store->heads.latest, row->object, &known))
        return true;
    if (seq > t->head)
        return seq <= t->made;
    return known.seq > asked ||
           (known.seq == seq &&
            memcmp(known.row, row->gone ? gone : row->mac, sizeof known.row) == 0);
}

static enum status not_known(struct errinfo *e)
{
    return errinfo_set(
        e, ST_ECORRUPT,
        "the latest entry of the audit log that tells of it is missing, or "
        "not what it was");
}

enum status row_event_latest(struct store_txn *t,
                             const unsigned char object[STORE_CHAIN_OBJECT],
                             struct row_event_row *row, struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT seq, row_mac FROM events WHERE chain = 0 AND object = $1 "
                  "ORDER BY seq DESC LIMIT 1",
                  sql_blob(object, STORE_CHAIN_OBJECT));
    const bool found = st == ST_OK && sql_next(r);
    const uint64_t seq = found ? (uint64_t)sql_column(r, 0).i : 0;

    memcpy(row->object, object, sizeof row->object);
    row->gone = !found || !store_column_bytes(r, 1, row->mac, sizeof row->mac);
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    return is_known(t, seq, row, t->head) ? ST_OK : not_known(e);
}

/* Entries of a subject's templates have its id too. */
enum status row_event_named(struct store_txn *t, const char *subject,
                            struct row_event_row *row, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct sql_rows *r;
    uint64_t seq = 0;
    enum status st;

    memset(row, 0, sizeof *row);
    row->gone = true;
    row_crypt_ref(t->vault, subject, ref);
    st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT object, row_mac, seq FROM events WHERE chain = 0 AND subject = $1 "
        "AND template_id = '' AND length(object) = 16 "
        "ORDER BY seq DESC LIMIT 1",
        sql_blob(ref, sizeof ref));
    if (st == ST_OK && sql_next(r) &&
        store_column_bytes(r, 0, row->object, sizeof row->object)) {
        row->gone = !store_column_bytes(r, 1, row->mac, sizeof row->mac);
        seq = (uint64_t)sql_column(r, 2).i;
    }
    if ((st = sql_done(r, st, e)) != ST_OK)
        return st;
    return is_known(t, seq, row, seq) ? ST_OK
                                      : not_known(e); /* it may be renamed since */
}

enum status row_event_was(struct store_txn *t, const struct row_event_row *row, bool *was,
                          struct errinfo *e)
{
    struct sql_rows *r;
    const enum status st = SQL_QUERY(
        t->sql, &r, e,
        "SELECT 1 FROM events WHERE chain = 0 AND object = $1 AND row_mac = $2",
        sql_blob(row->object, sizeof row->object), sql_blob(row->mac, sizeof row->mac));

    *was = st == ST_OK && sql_next(r);
    return sql_done(r, st, e);
}

enum status row_event_is(struct store_txn *t, const struct row_event_row *now,
                         struct errinfo *e)
{
    struct row_event_row latest;
    const enum status st = row_event_latest(t, now->object, &latest, e);

    if (st != ST_OK)
        return st;
    return !latest.gone && sodium_memcmp(latest.mac, now->mac, sizeof now->mac) == 0
               ? ST_OK
               : ST_ECORRUPT;
}

enum status row_event_erased(struct store_txn *t, const unsigned char uid[STORE_UID],
                             const char *subject, bool *erased, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF];
    struct sql_rows *r;
    enum status st;

    if (uid != NULL) {
        st = SQL_QUERY(t->sql, &r, e,
                       "SELECT 1 FROM events WHERE chain = 0 AND object = $1 "
                       "AND kind = 'delete_subject'",
                       sql_blob(uid, STORE_UID));
    } else {
        row_crypt_ref(t->vault, subject, ref);
        st = SQL_QUERY(t->sql, &r, e,
                       "SELECT 1 FROM events WHERE chain = 0 AND subject = $1 "
                       "AND kind = 'delete_subject'",
                       sql_blob(ref, sizeof ref));
    }
    *erased = st == ST_OK && sql_next(r);
    return sql_done(r, st, e);
}
