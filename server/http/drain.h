/* drain.h -- close a connection whose client is still sending (RFC 9112 section 9.6).
 * A socket closed with unread bytes in it is reset, and the client may lose the response
 * that it has not read yet.  So it is kept open for a while: shut down for writing, and read
 * from without keeping the bytes, until the client closes it or its time is over. */
#ifndef SERVER_DRAIN_H
#define SERVER_DRAIN_H

struct drain;

struct drain *drain_start(void); /* with a thread of its own; NULL: out of memory */

/* drain_adopt(l, fd): fd, non-blocking, is the drain's from now on; with too many of them it
 * is closed at once. */
void drain_adopt(struct drain *l, int fd);
void drain_stop(struct drain *l); /* closes all; NULL is allowed */

#endif
