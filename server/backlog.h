/* backlog.h -- the connections that a listening socket has taken and nobody has accepted yet:
 * closing the socket would reset them, and their clients may have sent a request already. */
#ifndef SERVER_BACKLOG_H
#define SERVER_BACKLOG_H

/* backlog_empty(fd, ms): take no new connections on fd and wait, up to ms, until another
 * thread has accepted those that are there.  Who connects meanwhile is neither taken nor
 * refused, and tries again by itself: so close fd soon.  The socket must not be shared with
 * another process, which could not use it any more. */
void backlog_empty(int fd, double ms);

#endif
