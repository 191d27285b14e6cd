/* live.h -- for a guard at a door: what was decided a moment ago, and why not. */
#ifndef SERVER_LIVE_H
#define SERVER_LIVE_H

struct request;
struct worker;

/* live_recent(r, w): the latest verifications and enrolments (recent.h), after=SEQ alone.
 * live_reset(r, w), live_reset_token(r, w): no verification of the subject, or by the token, has failed:
 * a lock-out ends. */
void live_recent(struct request *r, struct worker *w);
void live_reset(struct request *r, struct worker *w);
void live_reset_token(struct request *r, struct worker *w);

#endif
