/* erasures.h -- a thread that finds out what other processes have erased (surfacectl, another
 * daemon), and drops what the daemon keeps of it in memory: within a second.  If the store cannot
 * answer, the thread asks again until it can. */
#ifndef SERVER_ERASURES_H
#define SERVER_ERASURES_H

struct app;
struct erasures;

struct erasures *erasures_start(struct app *app); /* NULL: out of memory */
void erasures_stop(struct erasures *x);           /* NULL is allowed */

#endif
