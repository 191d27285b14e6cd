/* live.h -- handlers for a guard at a door: recent decisions, refusals and lock-outs. */
#ifndef SERVER_LIVE_H
#define SERVER_LIVE_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* live_recent(r, w): Lists the latest verifications and enrolments (recent.h), or, with after=SEQ, the newer
 * ones. */
void live_recent(struct request *r, struct worker *w);

/* live_reset(r, w): Deletes the failed attempts on a subject; a lock-out ends. */
void live_reset(struct request *r, struct worker *w);

/* live_reset_token(r, w): Deletes the failed attempts of a token; a lock-out ends. */
void live_reset_token(struct request *r, struct worker *w);

#endif
