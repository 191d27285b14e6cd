/* row_event.h -- the two chains of events (store_chain.h), inside a transaction. */
#ifndef DB_ROW_EVENT_H
#define DB_ROW_EVENT_H
#include "store_chain.h"
#include "store_types.h"

struct errinfo;
struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

struct row_event_row { /* of a table whose rows the changes leave */
    unsigned char object[STORE_CHAIN_OBJECT];
    unsigned char mac[VAULT_HASH]; /* store_mac() of it */
    bool gone;                     /* there is none */
    const unsigned char *ref; /* of the subject, where its id is not known; or NULL */
};

/* The object of changes that cut off uses (STORE_CHAIN_TRIM), which is no row. */
extern const unsigned char row_event_uses[STORE_CHAIN_OBJECT];

/* Receives a row; name: of it, for messages. */
typedef enum status row_event_see(void *arg, const struct row_event_row *now,
                                  const char *name, struct errinfo *e);

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

/* row_event_signs(t, by, kind, v, outcome, e): append to the changes that the vault's key
 * signs them from then on.
 * row_event_renew(t, next, e): the ends, which have MACs of t's vault, get those of the next. */
enum status row_event_signs(struct store_txn *t, const struct store_act *by,
                            const char *kind, const struct vault *v, const char *outcome,
                            struct errinfo *e);
enum status row_event_renew(struct store_txn *t, const struct vault *next,
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
 * gone also where there is no entry.
 * row_event_named(t, subject, row, e): the same of the subject that has this id; row->object is
 * 0 where none ever had.
 * row_event_was(t, row, was, e): did any entry of its object leave this row?
 * row_event_is(t, now, e): is this row what the latest entry of its object leaves of it?  Else
 * ST_ECORRUPT, without a text. */
enum status row_event_latest(struct store_txn *t,
                             const unsigned char object[STORE_CHAIN_OBJECT],
                             struct row_event_row *row, struct errinfo *e);
enum status row_event_named(struct store_txn *t, const char *subject,
                            struct row_event_row *row, struct errinfo *e);
enum status row_event_was(struct store_txn *t, const struct row_event_row *row, bool *was,
                          struct errinfo *e);
enum status row_event_is(struct store_txn *t, const struct row_event_row *now,
                         struct errinfo *e);

/* row_event_erased(t, uid, subject, erased, e): was the subject of this uid, or one that had this
 * id last, erased?  uid or subject is NULL. */
enum status row_event_erased(struct store_txn *t, const unsigned char uid[STORE_UID],
                             const char *subject, bool *erased, struct errinfo *e);

#endif
