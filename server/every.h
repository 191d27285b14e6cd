/* every.h -- a thread that calls a function periodically until it is stopped. */
#ifndef SERVER_EVERY_H
#define SERVER_EVERY_H

struct every; /* opaque */

/* every_start(name, ms, look, arg): Starts a thread that calls look(arg) at once, and again ms after each return.
 * NULL: no memory, no thread.
 *   name  of the thread; at most 15 characters */
struct every *every_start(const char *name, unsigned ms, void (*look)(void *arg),
                          void *arg);

/* every_stop(x): Waits for a call that runs, and ends the thread.  NULL is allowed. */
void every_stop(struct every *x);

#endif
