/* auth.h -- Bearer tokens (RFC 6750). */
#ifndef SERVER_AUTH_H
#define SERVER_AUTH_H

#include <stdbool.h>

struct request;
struct response;

/* auth_take(r, header): keep the token of the Authorization header's value (may be NULL) in
 * r->token.  Without a usable one r->response is set.  Does not read the store. */
void auth_take(struct request *r, const char *header);

/* auth_admit(r): may the token be checked?  False: r->address has sent too many wrong ones, and
 * r->response is set.  Does not read the store. */
bool auth_admit(struct request *r);

/* auth_check(r): is r->token one of the store's, with a scope of r->route?  Then r->actor
 * is its id, else r->response is set; where the store cannot say and the route needs no token, neither
 * is.  The token is wiped.  On a worker. */
void auth_check(struct request *r);

/* auth_free(r): r needs no token (--no-auth): it may do everything but make and revoke tokens, which
 * would outlive that.  False: r->response is set. */
bool auth_free(struct request *r);

/* auth_has(r, scopes): has r one of these scopes?  After auth_check() or auth_free(). */
bool auth_has(const struct request *r, unsigned scopes);

/* auth_scores(r): may the response say how much like an enrolled face one is that does not match?
 * r's token must have score, detail or manage: from ten such scores the face can be computed. */
bool auth_scores(const struct request *r);

/* auth_may(r, scopes): auth_has(); where it is false, r->response is a 403 that names
 * the scopes. */
bool auth_may(struct request *r, unsigned scopes);

/* auth_gives(r, scopes): may r make, renew or revoke a token of these scopes?  Its own token must have
 * all of them, where one is needed.  False: r->response is a 403. */
bool auth_gives(struct request *r, unsigned scopes);

#define AUTH_CHALLENGE_MAX 200

/* auth_challenge(a, out): the value of WWW-Authenticate, where a->challenge is set. */
void auth_challenge(const struct response *a, char out[AUTH_CHALLENGE_MAX]);

#endif
