/* row_end.h -- where a chain of events (store_chain.h) ends, and whether it has an entry. */
#ifndef DB_ROW_END_H
#define DB_ROW_END_H
#include <stdbool.h>
#include "store_chain.h"

struct errinfo;
struct sql_txn; /* sql.h */

/* row_end_read(t, v, chain, seq, hash, e), row_end_has(t, chain, seq, hash, has, e): as
 * row_event_end() and row_event_has(). */
enum status row_end_read(struct sql_txn *t, const struct vault *v, enum store_chain chain,
                         uint64_t *seq, unsigned char hash[STORE_CHAIN_HASH],
                         struct errinfo *e);
enum status row_end_has(struct sql_txn *t, enum store_chain chain, uint64_t seq,
                        const unsigned char hash[STORE_CHAIN_HASH], bool *has,
                        struct errinfo *e);

#endif
