/* proxy.h -- accepts connections for libmicrohttpd where some are of proxies that say by a
 * header (proxy_header.h) whose they are.  libmicrohttpd gets a connection when its header is
 * read, with the client's address as that of the connection, and so it counts everywhere:
 * rate limits, quotas, log.  Connections of others are passed on as they are. */
#ifndef SERVER_PROXY_H
#define SERVER_PROXY_H
#include "status.h"

struct MHD_Daemon;
struct errinfo;
struct guard;
struct proxy;

/* So many connections may wait for their header; for a further one the oldest is closed.  A proxy
 * may open as many as its backlog lets it before it sends the first header. */
#define PROXY_WAITING 1024
/* A header may take so long: the specification asks for 3 s, within which TCP repeats what was lost. */
#define PROXY_HEADER_MS 3000.0

/* proxy_start(from, fd, daemon, guard, out, e): accept connections of fd, a listening,
 * non-blocking socket, on a thread.  from: the proxies, as address_in_list().  daemon serves on a
 * thread of its own, without a socket to listen on, and with MHD_USE_ITC.  All are borrowed until
 * proxy_stop(), and *out is set before the first connection.  ST_OK, ST_ENOMEM. */
enum status proxy_start(const char *from, int fd, struct MHD_Daemon *daemon,
                        struct guard *guard, struct proxy **out, struct errinfo *e);

/* proxy_taken(p): daemon has begun to serve a connection.  On its thread; NULL is allowed. */
void proxy_taken(struct proxy *p);

/* proxy_stop(p): accept no more; those that wait for their header are closed.  More than once,
 * and NULL, are allowed. */
void proxy_stop(struct proxy *p);

void proxy_free(struct proxy *p); /* stopped, and daemon too; NULL is allowed */

#endif
