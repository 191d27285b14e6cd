/* rows_token.h -- the tokens' rows, inside a transaction. */
#ifndef DB_ROWS_TOKEN_H
#define DB_ROWS_TOKEN_H
#include "rows_table.h"
#include "rows_types.h"

#define ROWS_TOKEN_HASH 32 /* bytes of a secret's hash */

struct rows_token { /* an authentic row; token.expired is not set */
    struct store_token token;
    unsigned char hash[ROWS_TOKEN_HASH], old_hash[ROWS_TOKEN_HASH];
    char scopes[STORE_SCOPES_MAX]; /* set when the row is written */
    int64_t revision;
    unsigned char mac[CRYPT_HASH];
};

extern const struct rows_table rows_tokens;

/* rows_token_may_have(scopes, groups): Returns true if a token can have these scopes and be bound to these groups:
 * they are a list (groups.h), and audit, which is about all subjects, is only for tokens that are not bound. */
bool rows_token_may_have(unsigned scopes, const char *groups);

/* rows_token_get(t, id, out, e): Reads the token with this id.  ST_ENOTFOUND: also if the actor of t is bound to
 * groups, and the token is not bound to some of these; ST_ECORRUPT. */
enum status rows_token_get(struct log_txn *t, const char *id, struct rows_token *out,
                           struct errinfo *e);

/* rows_token_find(t, hash, out, e): Reads the token whose secret, or the secret before the last rotation, has
 * this hash.  ST_ENOTFOUND, ST_ECORRUPT. */
enum status rows_token_find(struct log_txn *t, const unsigned char hash[ROWS_TOKEN_HASH],
                            struct rows_token *out, struct errinfo *e);

/* rows_token_add(t, one, e): Adds a token. */
enum status rows_token_add(struct log_txn *t, struct rows_token *one, struct errinfo *e);

/* rows_token_write(t, one, e): Replaces the row of a token by *one. */
enum status rows_token_write(struct log_txn *t, struct rows_token *one,
                             struct errinfo *e);

/* rows_token_used(t, id, at, e): Sets the time of last use, which is not authenticated. */
enum status rows_token_used(struct log_txn *t, const char *id, const char *at,
                            struct errinfo *e);

#endif
