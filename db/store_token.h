/* store_token.h -- Bearer tokens: 256 random bits each, of which only a hash is kept. */
#ifndef DB_STORE_TOKEN_H
#define DB_STORE_TOKEN_H
#include "store_open.h"

/* store_token_create(s, actor, name, scopes, life_s, secret, t, e): a new Bearer token, good
 * for life_s seconds, 0: for ever; secret is shown once and only its hash is kept. */
enum status store_token_create(struct store *s, const char *actor, const char *name,
                               unsigned scopes, int64_t life_s, char secret[65],
                               struct store_token *t, struct errinfo *e);

/* store_token_rotate(s, actor, id, grace_s, life_s, secret, t, e): another secret for the
 * token; the one it had is good for another grace_s seconds, and one before that no more.
 * life_s: from now on, 0: for ever, negative: it expires when it would have.
 * ST_EDENIED: it was revoked. */
enum status store_token_rotate(struct store *s, const char *actor, const char *id,
                               int64_t grace_s, int64_t life_s, char secret[65],
                               struct store_token *t, struct errinfo *e);
enum status store_token_list(struct store *s, struct store_token **out, size_t *n,
                             struct errinfo *e);

#define STORE_TOKEN_SOON_S (INT64_C(30) * 86400) /* before its end, to be warned of */

/* store_token_left(t): seconds until t ends, INT64_MAX if never; 0: it has, or was revoked. */
int64_t store_token_left(const struct store_token *t);

/* store_token_revoke(s, actor, id, e): ST_OK also when it was revoked before. */
enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e);

/* store_token_check(s, secret, t, e): ST_OK and the token, or ST_EDENIED for an unknown,
 * malformed, expired or revoked one.  Compared in constant time.  Sees what was rotated or
 * revoked at once.  Notes at most once a minute that the token is in use, and only where
 * that waits neither for the disk nor for another writer. */
enum status store_token_check(struct store *s, const char *secret, struct store_token *t,
                              struct errinfo *e);

#endif
