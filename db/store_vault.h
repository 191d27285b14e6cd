/* store_vault.h -- the vaults of an open store.  One is kept while a transaction uses it, so that
 * what began before another process changed the master key ends with the key it knows; then the
 * old key is wiped. */
#ifndef DB_STORE_VAULT_H
#define DB_STORE_VAULT_H
#include <pthread.h>
#include <stdbool.h>
#include "errinfo.h"
#include "status.h"
#include "store_types.h"

struct sql_txn; /* sql.h */

struct store_vault { /* one that is known */
    struct vault *vault;
    struct vault_root root;
    unsigned users; /* transactions */
    struct store_vault *older;
};

struct store_vaults {
    pthread_mutex_t lock;
    struct store_vault *newest; /* NULL: none yet */
    const char *db;             /* the database's name, for messages */
    char *
        path; /* of the key; and ".new", where the next one is until it is in its place */
    const struct keyfile *given;
    enum vault_kind make;
    bool plaintext; /* the database must be plaintext, else must not be */
    bool weak;      /* a new passphrase may have few characters */
    bool made;      /* the key's file is new */
    /* when the newest root could not be opened, monotonic; 0: it could */
    int64_t failed_s;
    struct errinfo failed; /* why */
};

/* store_vault_init(v, db, key, e): db is borrowed.  store_vault_free(v) in any case. */
enum status store_vault_init(struct store_vaults *v, const char *db,
                             const struct store_key *key, struct errinfo *e);
void store_vault_free(struct store_vaults *v);

/* store_vault_take(v): the newest vault, in use until store_vault_release(v, it); NULL: none is
 * known yet.
 * store_vault_use(v, t, held, e): the vault of what the transaction sees instead of *held, which
 * was taken before the transaction began and is released if it is another.  A root that *held has
 * not authenticated (vault_follows()), or one older than its own, is ST_EREFUSED: that is not of
 * this program.  ST_EDENIED, ST_ENOTFOUND, ST_EINVAL: the key's file does not open the root; it
 * is tried again after a second.
 * store_vault_new(v, t, held, e): a first master key for a database that has none; if the
 * transaction is rolled back, store_vault_undo(v) removes a new key's file. */
struct store_vault *store_vault_take(struct store_vaults *v);
void store_vault_release(struct store_vaults *v, struct store_vault *held);
enum status store_vault_use(struct store_vaults *v, struct sql_txn *t,
                            struct store_vault **held, struct errinfo *e);
enum status store_vault_new(struct store_vaults *v, struct sql_txn *t,
                            struct store_vault **held, struct errinfo *e);
void store_vault_undo(struct store_vaults *v);

/* store_vault_read(t, r, e), store_vault_write(t, r, e): the key record.
 * store_vault_fits(path, r): does the file open it?
 * store_vault_keep(v, vault, root, e): it is the newest from now on; taken over in any case. */
enum status store_vault_read(struct sql_txn *t, struct vault_root *r, struct errinfo *e);
enum status store_vault_write(struct sql_txn *t, const struct vault_root *r,
                              struct errinfo *e);
bool store_vault_fits(const char *path, const struct vault_root *r);
enum status store_vault_keep(struct store_vaults *v, struct vault *vault,
                             const struct vault_root *root, struct errinfo *e);

#endif
