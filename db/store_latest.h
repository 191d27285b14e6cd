/* store_latest.h -- the latest change of each object, as an open store that serves has verified it
 * (store_state_verify()): its number, and the row that it left.  Where the database has another one
 * since, as it was removed, changed, or an older one copied behind it, the row that it tells of
 * is no good.  80 bytes an object. */
#ifndef DB_STORE_LATEST_H
#define DB_STORE_LATEST_H
#include <pthread.h>
#include "store_chain.h"

#define STORE_LATEST_ROW                                                                 \
    16 /* bytes of a row's MAC: as many as nobody finds another row for */

struct store_latest_slot {
    unsigned char object[STORE_CHAIN_OBJECT];
    unsigned char row[STORE_LATEST_ROW]; /* zeros: the row is gone */
    uint64_t seq;                        /* 0: free */
};

struct store_latest {
    pthread_mutex_t lock;
    struct store_latest_slot *slot; /* [room], a power of 2; NULL: nothing is kept */
    size_t room, n;
};

void store_latest_init(struct store_latest *l);
void store_latest_free(struct store_latest *l);

/* store_latest_begin(l): from now on they are kept.  store_latest_add(l, object, seq, row): where
 * they are; row: NULL: gone.  Both: false: no memory.
 * store_latest_find(l, object, out): out->seq 0: it has none.  False: they are not kept. */
bool store_latest_begin(struct store_latest *l);
bool store_latest_add(struct store_latest *l,
                      const unsigned char object[STORE_CHAIN_OBJECT], uint64_t seq,
                      const unsigned char *row);
bool store_latest_find(struct store_latest *l,
                       const unsigned char object[STORE_CHAIN_OBJECT],
                       struct store_latest_slot *out);

#endif
