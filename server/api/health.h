/* health.h -- handlers that report the state of the daemon. */
#ifndef SERVER_HEALTH_H
#define SERVER_HEALTH_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* health_live(r, w): Responds 200 as long as the I/O thread runs. */
void health_live(struct request *r, struct worker *w);

/* health_ready(r, w): Responds 200 and the calibration in force, or 503 and the reason.  It passes the queue like
 * any other request: 200 means that a worker has served it. */
void health_ready(struct request *r, struct worker *w);

/* health_version(r, w): Responds with the version of the program. */
void health_version(struct request *r, struct worker *w);

/* health_stats(r, w): Responds with the state and the statistics of daemon and database. */
void health_stats(struct request *r, struct worker *w);

#endif
