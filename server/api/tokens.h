/* tokens.h -- handlers of tokens.  A client can make, renew and revoke only tokens whose scopes its own
 * token has. */
#ifndef SERVER_TOKENS_H
#define SERVER_TOKENS_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* tokens_own(r, w): Describes the token of r; without one, all scopes. */
void tokens_own(struct request *r, struct worker *w);

void tokens_list(struct request *r, struct worker *w);
void tokens_create(struct request *r, struct worker *w);
void tokens_rotate(struct request *r, struct worker *w);
void tokens_revoke(struct request *r, struct worker *w);

#endif
