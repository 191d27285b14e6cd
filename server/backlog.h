/* backlog.h -- empties the backlog of a listening socket: closing the socket would reset the
 * connections that are not accepted yet, whose clients may have sent a request already. */
#ifndef SERVER_BACKLOG_H
#define SERVER_BACKLOG_H

/* backlog_empty(fd, ms): take no new connections on fd and wait, up to ms, until another
 * thread has accepted those that are there.  A client that connects meanwhile is
 * neither accepted nor refused, and its TCP retries: so close fd soon.  The socket must not be
 * shared with another process, which could not use it any more. */
void backlog_empty(int fd, double ms);

#endif
