/* row_event.h -- the two chains of events (store_chain.h), inside a transaction. */
#ifndef DB_ROW_EVENT_H
#define DB_ROW_EVENT_H
#include "store_chain.h"
#include "store_types.h"

struct errinfo;
struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

struct row_event_row { /* of a table whose rows an act changes */
    unsigned char object[STORE_CHAIN_OBJECT];
    unsigned char mac[VAULT_HASH]; /* row_state.h */
    bool gone;                     /* there is none */
};

/* row_event_begin(t, e): of a new database, which has none.
 * row_event_end(t, chain, seq, hash, e): number and hash of the chain's last event, 0 and zeros
 * where there was none; ST_ECORRUPT: the end is missing, or has not the MAC of the database's
 * key.
 * row_event_has(t, chain, seq, hash, has, e): has the chain an entry of this number with this
 * hash?  Then all before it are the same too; number 0 and zeros are the beginning. */
enum status row_event_begin(struct store_txn *t, struct errinfo *e);
enum status row_event_end(struct store_txn *t, enum store_chain chain, uint64_t *seq,
                          unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e);
enum status row_event_has(struct store_txn *t, enum store_chain chain, uint64_t seq,
                          const unsigned char hash[STORE_CHAIN_HASH], bool *has,
                          struct errinfo *e);

/* row_event_add(t, by, kind, subject, template_id, outcome, e): append to the changes, and sign
 * where that is due.  subject: "" for none.
 * row_event_leave(t, by, ..., left, e): the same of an act on a row, and what it leaves of it.
 * row_event_use(t, by, ..., e): append to the uses.
 * Each follows on what the end says, so that the loss of entries can never be covered up. */
enum status row_event_add(struct store_txn *t, const struct store_act *by,
                          const char *kind, const char *subject, const char *template_id,
                          const char *outcome, struct errinfo *e);
enum status row_event_leave(struct store_txn *t, const struct store_act *by,
                            const char *kind, const char *subject,
                            const char *template_id, const char *outcome,
                            const struct row_event_row *left, struct errinfo *e);
enum status row_event_use(struct store_txn *t, const struct store_act *by,
                          const char *kind, const char *subject, const char *template_id,
                          const char *outcome, struct errinfo *e);

/* row_event_latest(t, object, row, e): what the latest entry of an object leaves of its row;
 * gone where there is no entry. */
enum status row_event_latest(struct store_txn *t,
                             const unsigned char object[STORE_CHAIN_OBJECT],
                             struct row_event_row *row, struct errinfo *e);

#endif
