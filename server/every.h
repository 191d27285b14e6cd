/* every.h -- a thread that does the same again and again, until it is stopped. */
#ifndef SERVER_EVERY_H
#define SERVER_EVERY_H

struct every; /* opaque */

/* every_start(name, ms, look, arg): a thread of this name (at most 15 characters) calls look(arg) at
 * once, and again ms after it returned.  NULL: no memory, no thread. */
struct every *every_start(const char *name, unsigned ms, void (*look)(void *arg),
                          void *arg);

/* every_stop(x): waits for a call that runs; there is none afterwards.  NULL is allowed. */
void every_stop(struct every *x);

#endif
