/* peer.h -- what is known of a connection beside its requests: its place in the limits
 * (guard.h) and its TLS session.  On the I/O thread only. */
#ifndef SERVER_PEER_H
#define SERVER_PEER_H
#include <stdbool.h>
#include <stddef.h>
#include "guard.h"

struct MHD_Connection;
struct peer;
struct tls;

/* What all connections share; borrowed until the last one is closed. */
struct peer_host {
    struct guard *guard;
    struct tls *tls; /* NULL: plain HTTP */
};

/* peer_open(host, conn): conn has just begun; with TLS its session gets the certificate in
 * force.  NULL: out of memory, and the connection is shut down. */
struct peer *peer_open(const struct peer_host *host, struct MHD_Connection *conn);

/* peer_close(p): its TLS session is no more, but its socket is still open.  NULL is
 * allowed. */
void peer_close(struct peer *p);

/* peer_begin(p, step, bytes): the step begins, with so many bytes to go; peer_more(): that
 * many more than was known.  See guard_begin(), guard_more(). */
void peer_begin(struct peer *p, enum guard_step step, size_t bytes);
void peer_more(struct peer *p, size_t bytes);

int peer_socket(const struct peer *p);

/* peer_send(p, data, len): past libmicrohttpd; true when all of it went into the socket's
 * buffer. */
bool peer_send(const struct peer *p, const void *data, size_t len);

#endif
