/* row_event.h -- the end of the events (store_chain.h), inside a transaction. */
#ifndef DB_ROW_EVENT_H
#define DB_ROW_EVENT_H
#include "store_chain.h"

struct errinfo;
struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

/* row_event_begin(t, e): of a new database, which has none.
 * row_event_end(t, seq, hash, e): number and hash of the last event; ST_ECORRUPT: the end is
 * missing, or has not the MAC of the database's key.
 * row_event_add(t, by, kind, subject, template_id, outcome, e): append, and sign where that is
 * due.  subject: "" for none.  It follows on what the end says, so that the loss of entries can
 * never be covered up. */
enum status row_event_begin(struct store_txn *t, struct errinfo *e);
enum status row_event_end(struct store_txn *t, uint64_t *seq,
                          unsigned char hash[STORE_CHAIN_HASH], struct errinfo *e);
enum status row_event_add(struct store_txn *t, const struct store_act *by,
                          const char *kind, const char *subject, const char *template_id,
                          const char *outcome, struct errinfo *e);

#endif
