/* ahead.h -- a thread that loads templates while a worker still parses and builds the probe
 * they will be compared with, so that the verification seldom waits for the disk. */
#ifndef SERVER_AHEAD_H
#define SERVER_AHEAD_H

struct ahead;
struct app;

struct ahead *ahead_start(const struct app *app); /* its thread; NULL: out of memory */

/* ahead_ask(a, id): queue template id for cache_load().  Never blocks; when the queue is full
 * the template is not queued, and cache_hold() loads it. */
void ahead_ask(struct ahead *a, const char *id);
void ahead_stop(struct ahead *a); /* NULL is allowed */

#endif
