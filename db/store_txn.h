/* store_txn.h -- an open store, and a transaction with the keys of what it sees. */
#ifndef DB_STORE_TXN_H
#define DB_STORE_TXN_H
#include <stdatomic.h>
#include "sql.h"
#include "store_anchor.h"
#include "store_head.h"
#include "store_types.h"
#include "store_vault.h"

struct store {
    struct sql *sql;
    char *path;
    const struct model *model; /* store_use_model() */
    char made_by[FACE_ENGINE_MAX + 1];
    struct store_vaults vaults;
    struct store_heads heads;
    struct store_anchor anchor;
    bool open;             /* store_open() has succeeded */
    struct store_refusal { /* of the database as a whole, until it is opened again */
        atomic_flag begun;
        atomic_bool stands; /* why is written */
        struct errinfo why;
    } refusal;
    _Atomic int64_t scrubbed; /* the last change that was looked at for erasures */
};

struct store_txn {
    struct store *store;
    struct sql_txn *sql;
    const struct vault *vault; /* held->vault */
    struct store_vault *held;
    enum sql_begin how;
    uint64_t head; /* the last change that it sees; 0: not known */
    uint64_t made; /* the last one that it has made itself; 0: none */
    /* MAC of the subject's row found good last, or zeros */
    unsigned char good[VAULT_HASH];
};

/* store_txn_begin(s, how, t, e): as sql_begin().  ST_EREFUSED: the database is not the one that
 * was opened, or an older one (for good), or its key was changed and the new one is not known here.
 * store_txn_end(t, st, e): as sql_end().  Where it sees that another process has erased, that
 * one's bytes are scrubbed too: it may have ended before it could.
 * store_txn_refuse(s, e): what e says of the database was found by a transaction: while the store
 * is open, every other one fails with it from now on.  Returns ST_EREFUSED. */
enum status store_txn_begin(struct store *s, enum sql_begin how, struct store_txn *t,
                            struct errinfo *e);
enum status store_txn_end(struct store_txn *t, enum status st, struct errinfo *e);
enum status store_txn_refuse(struct store *s, struct errinfo *e);

/* store_txn_erasures(t, after, last, erased, e): were there any after the event `after`?  *last: of
 * all events, 0 where there are none. */
enum status store_txn_erasures(struct store_txn *t, int64_t after, int64_t *last,
                               bool *erased, struct errinfo *e);

/* store_txn_scrub(s): deleted bytes leave the file and its WAL, after an erasure.
 * store_txn_seen(s, e): erasures up to now are not for store_txn_end() to see. */
void store_txn_scrub(struct store *s);
enum status store_txn_seen(struct store *s, struct errinfo *e);

/* For reports of store_check() and its like: a problem a line. */
typedef void store_report(void *arg, const char *line);

#endif
