/* store_vault.h -- the vaults of an open store.  They are kept until it is closed, so that a
 * transaction that began before another process changed the master key ends with the one it
 * knows. */
#ifndef DB_STORE_VAULT_H
#define DB_STORE_VAULT_H
#include <pthread.h>
#include <stdbool.h>
#include "status.h"
#include "store_types.h"

struct errinfo;
struct sql_txn; /* sql.h */

#define STORE_VAULT_MAX 64 /* changes of the master key while a store is open */

struct store_vaults {
    pthread_mutex_t lock;
    struct vault *list[STORE_VAULT_MAX];
    int n;          /* the newest is the last */
    const char *db; /* the database's name, for messages */
    char *
        path; /* of the key; and ".new", where the next one is until it is in its place */
    bool named; /* by the caller: the database must have a key */
    const struct keyfile *given;
    enum vault_kind make;
    bool made; /* the key's file is new */
};

/* store_vault_init(v, db, key, e): db is borrowed.  store_vault_free(v) in any case. */
enum status store_vault_init(struct store_vaults *v, const char *db,
                             const struct store_key *key, struct errinfo *e);
void store_vault_free(struct store_vaults *v);

/* store_vault_new(v, t, out, e): a first master key for a database that has none; if the
 * transaction is rolled back, store_vault_undo(v) removes a new key's file.
 * store_vault_use(v, t, out, e): the vault of what the transaction sees, v's.  ST_EDENIED: not
 * the key of the database, or it is plaintext where a key is expected; as keyfile_read(). */
enum status store_vault_new(struct store_vaults *v, struct sql_txn *t,
                            const struct vault **out, struct errinfo *e);
void store_vault_undo(struct store_vaults *v);
enum status store_vault_use(struct store_vaults *v, struct sql_txn *t,
                            const struct vault **out, struct errinfo *e);

/* store_vault_read(t, r, e), store_vault_write(t, r, e): the key record.
 * store_vault_fits(path, r): does the file open it?
 * store_vault_keep(v, vault, e): it is the one of its version from now on; taken over. */
enum status store_vault_read(struct sql_txn *t, struct vault_root *r, struct errinfo *e);
enum status store_vault_write(struct sql_txn *t, const struct vault_root *r,
                              struct errinfo *e);
bool store_vault_fits(const char *path, const struct vault_root *r);
enum status store_vault_keep(struct store_vaults *v, struct vault *vault,
                             struct errinfo *e);

#endif
