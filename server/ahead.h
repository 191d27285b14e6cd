/* ahead.h -- templates are loaded while the probe they will be compared with is still being
 * read and prepared, so that a verification waits for the disk as little as it can. */
#ifndef SERVER_AHEAD_H
#define SERVER_AHEAD_H

struct ahead;
struct app;

struct ahead *ahead_start(const struct app *app); /* its thread; NULL: out of memory */

/* ahead_ask(a, id): have template id in app's cache soon, if it is not (cache_load()).  Never
 * waits; when too much is asked for already, nothing is done: who holds it then loads it. */
void ahead_ask(struct ahead *a, const char *id);
void ahead_stop(struct ahead *a); /* NULL is allowed */

#endif
