/* upkeep.h -- a thread for what the daemon does by itself: it verifies the rows against the change log, as
 * often as 2 % of a core allows; and every hour it looks for tokens that expire soon (expiry.h) and deletes
 * the oldest entries of the access log. */
#ifndef SERVER_UPKEEP_H
#define SERVER_UPKEEP_H

struct app;    /* app.h */
struct upkeep; /* opaque */

/* upkeep_start(app, days): Starts the thread.  NULL: no memory, no thread.
 *   app   borrowed; its store was verified just now
 *   days  that entries of the access log are kept; 0: for ever */
struct upkeep *upkeep_start(struct app *app, unsigned days);

/* upkeep_stop(u): Stops the thread.  NULL is allowed. */
void upkeep_stop(struct upkeep *u);

#endif
