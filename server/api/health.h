/* health.h -- is the daemon alive, is it ready for requests, and which program is it? */
#ifndef SERVER_HEALTH_H
#define SERVER_HEALTH_H

struct request;
struct worker;

/* health_live(r, w): 200 as long as the I/O thread runs. */
void health_live(struct request *r, struct worker *w);

/* health_ready(r, w): 200 and the calibration in force, or 503 and the reason.  It goes
 * through the queue like any other request, so that 200 means that a worker has served it. */
void health_ready(struct request *r, struct worker *w);

/* health_version(r, w): the program's version.
 * health_stats(r, w): how daemon and database are. */
void health_version(struct request *r, struct worker *w);
void health_stats(struct request *r, struct worker *w);

#endif
