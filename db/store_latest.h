/* store_latest.h -- the number of the latest change of each object, as an open store that serves
 * has verified it (store_state_verify()): where the entry is gone from the database since, the row
 * that it replaced is no good, although an earlier entry left it.  48 bytes an object. */
#ifndef DB_STORE_LATEST_H
#define DB_STORE_LATEST_H
#include <pthread.h>
#include "store_chain.h"

struct store_latest_slot {
    unsigned char object[STORE_CHAIN_OBJECT];
    uint64_t seq; /* 0: free */
};

struct store_latest {
    pthread_mutex_t lock;
    struct store_latest_slot *slot; /* [room], a power of 2; NULL: nothing is kept */
    size_t room, n;
};

void store_latest_init(struct store_latest *l);
void store_latest_free(struct store_latest *l);

/* store_latest_begin(l): from now on they are kept.  store_latest_add(l, object, seq): where they
 * are.  Both: false: no memory.  store_latest_find(l, object): 0: not known. */
bool store_latest_begin(struct store_latest *l);
bool store_latest_add(struct store_latest *l,
                      const unsigned char object[STORE_CHAIN_OBJECT], uint64_t seq);
uint64_t store_latest_find(struct store_latest *l,
                           const unsigned char object[STORE_CHAIN_OBJECT]);

#endif
