/* watch.h -- the route of the events. */
#ifndef SERVER_WATCH_H
#define SERVER_WATCH_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* watch_events(r, w): GET /v1/events.  The response may come later (r->waits). */
void watch_events(struct request *r, struct worker *w);

#endif
