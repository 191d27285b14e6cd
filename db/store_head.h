/* store_head.h -- how far an open store has seen the chain of changes.  It never goes back:
 * each transaction that finds it longer verifies what was added, and one that finds another
 * chain is refused. */
#ifndef DB_STORE_HEAD_H
#define DB_STORE_HEAD_H
#include <pthread.h>
#include "store_latest.h"

struct errinfo;
struct sql_txn; /* sql.h */

struct store_head {
    bool known;
    uint64_t seq; /* of the last change, and its hash */
    unsigned char hash[STORE_CHAIN_HASH];
    uint64_t least; /* what was committed here since */
};

struct store_heads {
    pthread_mutex_t lock;
    struct store_head newest;
    struct store_latest latest;
};

void store_head_init(struct store_heads *h);
void store_head_free(struct store_heads *h);

/* store_head_now(h): to be asked before a transaction begins, which then sees as much at least.
 * store_head_see(h, t, v, before, seq, e): is the end that t sees that of the same chain?
 * *seq: its number.  ST_EREFUSED: it is not.  What is wrong with the end of a store that
 * is just being opened is for others to find.
 * store_head_made(h, seq): a transaction of this store has committed this end, and after that none
 * may see less. */
struct store_head store_head_now(struct store_heads *h);
enum status store_head_see(struct store_heads *h, struct sql_txn *t,
                           const struct vault *v, const struct store_head *before,
                           uint64_t *seq, struct errinfo *e);
void store_head_made(struct store_heads *h, uint64_t seq);

#endif
