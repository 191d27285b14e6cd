/* auth.h -- Bearer tokens (RFC 6750). */
#ifndef SERVER_AUTH_H
#define SERVER_AUTH_H

#include <stdbool.h>

struct request;
struct response;

/* auth_take(r, header): keep the token of the Authorization header's value (may be NULL) in
 * r->token.  Without a usable one r->response is set.  Does not read the store. */
void auth_take(struct request *r, const char *header);

/* auth_admit(r): true: the token may be checked.  False: r->address is rate-limited for wrong
 * tokens, and r->response is set.  Does not read the store. */
bool auth_admit(struct request *r);

/* auth_check(r): is r->token one of the store's, with the scope of r->route?  Then r->actor
 * is its id, else r->response is set.  The token is wiped.  On a worker. */
void auth_check(struct request *r);

/* auth_has(r, scopes): has r's token one of these scopes, or is no token needed?  After
 * auth_check(). */
bool auth_has(const struct request *r, unsigned scopes);

/* auth_exact(r): whether the response may have exact scores: r's token has detail or
 * manage.  Many of them would rebuild a face. */
bool auth_exact(const struct request *r);

/* auth_may(r, scopes): auth_has(); where it is false, r->response is a 403 that names
 * the scopes. */
bool auth_may(struct request *r, unsigned scopes);

/* auth_gives(r, scopes): has r's token all of these scopes, as who gives them must have, or is no
 * token needed?  Else a 403 as well. */
bool auth_gives(struct request *r, unsigned scopes);

#define AUTH_CHALLENGE_MAX 160

/* auth_challenge(a, out): the value of WWW-Authenticate, where a->challenge is set. */
void auth_challenge(const struct response *a, char out[AUTH_CHALLENGE_MAX]);

#endif
