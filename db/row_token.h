/* row_token.h -- the rows of tokens, inside a transaction. */
#ifndef DB_ROW_TOKEN_H
#define DB_ROW_TOKEN_H
#include "row_event.h"
#include "store_types.h"

struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

#define ROW_TOKEN_HASH 32 /* bytes of a secret's hash */

struct row_token { /* expired is not set */
    struct store_token token;
    unsigned char hash[ROW_TOKEN_HASH], old_hash[ROW_TOKEN_HASH];
    bool old; /* row_token_find(): old_hash is the one that was looked for */
};

/* row_token_get(t, id, out, e), row_token_find(t, hash, out, e): by id, by the hash of the
 * secret or of the one before the last rotation.  ST_ENOTFOUND, ST_ECORRUPT.
 * row_token_each(t, see, arg, e): every row as it is, not verified.
 * row_token_list(t, out, n, e): oldest first; released by free().
 * row_token_add(t, one, e): with one->hash.
 * row_token_rotate(t, one, e): its hash is one->hash, the one before is good until
 * token.old_until ("": no more), and it expires at token.expires.
 * row_token_revoke(t, id, at, e): a damaged one too, which is good for nothing then, whatever
 * else its row says; ST_ENOTFOUND.
 * row_token_tell(t, by, kind, id, e): append to the changes what an act leaves of the row, as it
 * is now.
 * row_token_used(t, id, at, e): it was used; this is not authenticated. */
enum status row_token_get(struct store_txn *t, const char *id, struct row_token *out,
                          struct errinfo *e);
enum status row_token_find(struct store_txn *t, const unsigned char hash[ROW_TOKEN_HASH],
                           struct row_token *out, struct errinfo *e);
enum status row_token_each(struct store_txn *t, row_event_see *see, void *arg,
                           struct errinfo *e);
enum status row_token_list(struct store_txn *t, struct store_token **out, size_t *n,
                           struct errinfo *e);
enum status row_token_add(struct store_txn *t, const struct row_token *one,
                          struct errinfo *e);
enum status row_token_rotate(struct store_txn *t, const struct row_token *one,
                             struct errinfo *e);
enum status row_token_revoke(struct store_txn *t, const char *id, const char *at,
                             struct errinfo *e);
enum status row_token_tell(struct store_txn *t, const struct store_act *by,
                           const char *kind, const char *id, struct errinfo *e);
enum status row_token_used(struct store_txn *t, const char *id, const char *at,
                           struct errinfo *e);

#endif
