#include "row_event.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "store_column.h"
#include "store_rules.h"
#include "row_crypt.h"
#include "store_txn.h"

static enum status read_end(const struct store_txn *t, const struct sql_rows *r,
                            uint64_t *seq, unsigned char hash[STORE_CHAIN_HASH],
                            struct errinfo *e)
{
    unsigned char mac[STORE_CHAIN_HASH], wanted[STORE_CHAIN_HASH];
    bool sound = store_column_bytes(r, 1, hash, STORE_CHAIN_HASH) &&
                 store_column_bytes(r, 2, mac, sizeof mac);

    *seq = (uint64_t)sql_column(r, 0).i;
    if (sound) {
        store_chain_end(t->vault, *seq, hash, wanted);
        sound = sodium_memcmp(mac, wanted, sizeof mac) == 0;
    }
    return sound ? ST_OK
                 : errinfo_set(e, ST_ECORRUPT,
                               "the end of the audit log is not what was written");
}

enum status row_event_end(struct store_txn *t, uint64_t *seq,
                          unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    struct sql_rows *r;
    enum status st =
        sql_query(t->sql, "SELECT seq, hash, mac FROM events_end", NULL, 0, &r, e);
    bool found;

    *seq = 0;
    memset(hash, 0, STORE_CHAIN_HASH);
    if ((found = st == ST_OK && sql_next(r)))
        st = read_end(t, r, seq, hash, e);
    st = sql_done(r, st, e);
    return st != ST_OK || found
               ? st
               : errinfo_set(e, ST_ECORRUPT, "the end of the audit log is missing");
}

static enum status set_end(struct store_txn *t, uint64_t seq,
                           const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    unsigned char mac[STORE_CHAIN_HASH];

    store_chain_end(t->vault, seq, hash, mac);
    return SQL_RUN(t->sql, e,
                   "INSERT INTO events_end (events_key, seq, hash, mac) "
                   "VALUES (1, $1, $2, $3) ON CONFLICT (events_key) DO UPDATE "
                   "SET seq = excluded.seq, hash = excluded.hash, mac = excluded.mac",
                   sql_int((int64_t)seq), sql_blob(hash, STORE_CHAIN_HASH),
                   sql_blob(mac, sizeof mac));
}

enum status row_event_begin(struct store_txn *t, struct errinfo *e)
{
    static const unsigned char start[STORE_CHAIN_HASH];

    return set_end(t, 0, start, e);
}

static enum status add_mark(struct store_txn *t, uint64_t seq, const char *at,
                            const unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e)
{
    struct store_chain_mark m = {.seq = seq};

    (void)snprintf(m.at, sizeof m.at, "%s", at);
    memcpy(m.hash, hash, sizeof m.hash);
    store_chain_sign(t->vault, &m);
    return SQL_RUN(
        t->sql, e,
        "INSERT INTO checkpoints (seq, at, hash, signature) VALUES ($1, $2, $3, $4)",
        sql_int((int64_t)seq), sql_text(m.at), sql_blob(m.hash, sizeof m.hash),
        sql_blob(m.signature, sizeof m.signature));
}

enum status row_event_add(struct store_txn *t, const struct store_act *by,
                          const char *kind, const char *subject, const char *template_id,
                          const char *outcome, struct errinfo *e)
{
    unsigned char ref[ROW_CRYPT_REF], hash[STORE_CHAIN_HASH];
    struct store_chain_entry entry = {.at = by->at,
                                      .kind = kind,
                                      .actor = by->actor,
                                      .subject = ref,
                                      .template_id = template_id,
                                      .outcome = outcome};
    enum status st;

    if ((st = row_event_end(t, &entry.seq, hash, e)) != ST_OK)
        return st;
    entry.seq++;
    if (subject[0] != '\0') {
        row_crypt_ref(t->vault, subject, ref);
        entry.nsubject = sizeof ref;
    }
    store_chain_next(hash, &entry, hash);
    st = SQL_RUN(t->sql, e,
                 "INSERT INTO events (seq, at, kind, actor, subject, template_id, "
                 "outcome, hash) VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
                 sql_int((int64_t)entry.seq), sql_text(by->at), sql_text(kind),
                 sql_text(by->actor), sql_blob(ref, entry.nsubject),
                 sql_text(template_id), sql_text(outcome), sql_blob(hash, sizeof hash));
    if (st == ST_OK)
        st = set_end(t, entry.seq, hash, e);
    if (st == ST_OK && store_chain_due(entry.seq, kind))
        st = add_mark(t, entry.seq, by->at, hash, e);
    return st;
}
