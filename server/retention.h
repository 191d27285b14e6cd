/* retention.h -- the audit log's oldest uses cut off, by a thread of its own, now and
 * every hour. */
#ifndef SERVER_RETENTION_H
#define SERVER_RETENTION_H

struct retention; /* opaque */
struct store;     /* store.h */

/* retention_start(s, days): s is borrowed.  NULL: no memory, no thread.
 * retention_stop(r): NULL is allowed. */
struct retention *retention_start(struct store *s, unsigned days);
void retention_stop(struct retention *r);

#endif
