/* health.h -- is the daemon there, and may requests be sent to it? */
#ifndef SERVER_HEALTH_H
#define SERVER_HEALTH_H

struct request;
struct worker;

/* health_live(r, w): 200 as long as the I/O thread answers. */
void health_live(struct request *r, struct worker *w);

/* health_ready(r, w): 200 and the calibration in force, or 503 and the reason.  It waits in
 * the queue like any other, so that an answer means that a worker serves it. */
void health_ready(struct request *r, struct worker *w);

#endif
