/* proxy.h -- accepts connections for libmicrohttpd if some come from proxies that name their clients in a
 * header (proxy_header.h).  It reads the header, then hands the connection to libmicrohttpd with the client's
 * address as that of the connection.  So rate limits, quotas and log see the client's address.  Connections
 * that do not come from a proxy are handed on at once. */
#ifndef SERVER_PROXY_H
#define SERVER_PROXY_H
#include "status.h"

struct MHD_Daemon;
struct errinfo;
struct guard;
struct proxy;

/* Limit of connections that wait for their header; a further one closes the oldest.  A proxy may open as many
 * as the backlog holds before it sends the first header. */
#define PROXY_WAITING 1024
/* Time for a header, ms.  The specification asks for 3 s, within which TCP repeats lost packets. */
#define PROXY_HEADER_MS 3000.0

/* proxy_start(from, fd, daemon, guard, out, e): Accepts connections on a new thread.  All arguments are borrowed
 * until proxy_stop().  Sets *out before the first connection.
 *   from    the proxies, as in address_in_list()
 *   fd      listening, non-blocking socket
 *   daemon  serves on a thread of its own, without a listening socket, with MHD_USE_ITC
 * ST_OK, ST_ENOMEM. */
enum status proxy_start(const char *from, int fd, struct MHD_Daemon *daemon,
                        struct guard *guard, struct proxy **out, struct errinfo *e);

/* proxy_taken(p): Tells p that the daemon has begun to serve a connection.  On the daemon's thread; NULL is
 * allowed. */
void proxy_taken(struct proxy *p);

/* proxy_stop(p): Accepts no more connections, and closes those that wait for their header.  More than one call,
 * and NULL, are allowed. */
void proxy_stop(struct proxy *p);

/* proxy_free(p): Releases p; p and the daemon have stopped.  NULL is allowed. */
void proxy_free(struct proxy *p);

#endif
