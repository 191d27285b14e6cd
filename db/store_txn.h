/* store_txn.h -- an open store, and a transaction with the keys of what it sees. */
#ifndef DB_STORE_TXN_H
#define DB_STORE_TXN_H
#include <stdatomic.h>
#include "sql.h"
#include "store_types.h"
#include "store_vault.h"

struct store {
    struct sql *sql;
    char *path;
    const struct model *model; /* store_use_model() */
    char made_by[FACE_ENGINE_MAX + 1];
    struct store_vaults vaults;
    bool open;                /* store_open() has succeeded */
    atomic_bool keyless;      /* the key was changed since, and is not known */
    _Atomic int64_t scrubbed; /* the last event that was looked at for erasures */
};

struct store_txn {
    struct store *store;
    struct sql_txn *sql;
    const struct vault *vault;
    enum sql_begin how;
};

/* store_txn_begin(s, how, t, e): as sql_begin().  A key that is lost or changed while the store
 * is open is the database's trouble, ST_EDB: the caller lacks no permission.
 * store_txn_end(t, st, e): as sql_end().  Where it sees that another process has erased, that
 * one's bytes are scrubbed too: it may have ended before it could. */
enum status store_txn_begin(struct store *s, enum sql_begin how, struct store_txn *t,
                            struct errinfo *e);
enum status store_txn_end(struct store_txn *t, enum status st, struct errinfo *e);

/* store_txn_scrub(s): deleted bytes leave the file and its WAL, after an erasure.
 * store_txn_seen(s, e): erasures up to now are not for store_txn_end() to see. */
void store_txn_scrub(struct store *s);
enum status store_txn_seen(struct store *s, struct errinfo *e);

/* For reports of store_check() and its like: a problem a line. */
typedef void store_report(void *arg, const char *line);

#endif
