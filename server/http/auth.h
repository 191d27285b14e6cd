/* auth.h -- Bearer tokens (RFC 6750). */
#ifndef SERVER_AUTH_H
#define SERVER_AUTH_H

#include <stdbool.h>

struct request;
struct response;

/* auth_take(r, header): Copies the token to r->token.  Returns false if there is none, it is malformed, or
 * r->address has sent too many wrong tokens; then sets r->response.  Does not read the store.
 *   header  value of Authorization; NULL: none */
bool auth_take(struct request *r, const char *header);

/* auth_check(r): Looks for r->token in the store, and wipes it.  If it is valid, sets the fields of the token in
 * r.  If it is not, or has no scope of r->route, sets r->response.  If the store fails on a route that needs
 * no token, sets neither.  On a worker. */
void auth_check(struct request *r);

/* auth_free(r): Without tokens (--no-auth): gives r all scopes except tokens, because a new token would
 * outlive the daemon.  Returns false if r->route needs that scope; then sets r->response. */
bool auth_free(struct request *r);

/* auth_has(r, scopes): Returns true if r has one of these scopes.  After auth_check() or auth_free(). */
bool auth_has(const struct request *r, unsigned scopes);

/* auth_scores(r): Returns true if the response may tell the score of a non-match.  The token needs score,
 * detail or manage, because the enrolled face can be computed from ten such scores. */
bool auth_scores(const struct request *r);

/* auth_may(r, scopes): Like auth_has(); if false, sets r->response to a 403 that names the scopes. */
bool auth_may(struct request *r, unsigned scopes);

/* auth_gives(r, scopes): Returns true if r may create, rotate or revoke a token of these scopes: its own token
 * has all of them.  If false, sets r->response to a 403. */
bool auth_gives(struct request *r, unsigned scopes);

#define AUTH_CHALLENGE_MAX 200

/* auth_challenge(a, out): Writes the value of WWW-Authenticate; a->challenge is set. */
void auth_challenge(const struct response *a, char out[AUTH_CHALLENGE_MAX]);

#endif
