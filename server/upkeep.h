/* upkeep.h -- what the daemon does by itself, in a thread of its own: the rows are verified against
 * the change log, as often as 2 % of a core allows; the access log's oldest entries are cut off,
 * every hour. */
#ifndef SERVER_UPKEEP_H
#define SERVER_UPKEEP_H

struct app;    /* app.h */
struct upkeep; /* opaque */

/* upkeep_start(app, days): app is borrowed; its store was verified just now.  days: that accesses
 * are kept, 0: for ever.  NULL: no memory, no thread.
 * upkeep_stop(u): NULL is allowed. */
struct upkeep *upkeep_start(struct app *app, unsigned days);
void upkeep_stop(struct upkeep *u);

#endif
