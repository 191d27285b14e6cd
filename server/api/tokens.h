/* tokens.h -- the tokens that clients have. */
#ifndef SERVER_TOKENS_H
#define SERVER_TOKENS_H

struct request;
struct worker;

/* tokens_own(r, w): the one that r has, and what it may do; without one, everything. */
void tokens_own(struct request *r, struct worker *w);

/* All tokens.  Nobody gets a secret of one that may do what his own may not. */
void tokens_list(struct request *r, struct worker *w);
void tokens_create(struct request *r, struct worker *w);
void tokens_rotate(struct request *r, struct worker *w);
void tokens_revoke(struct request *r, struct worker *w);

#endif
