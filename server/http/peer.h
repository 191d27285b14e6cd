/* peer.h -- a connection beyond its requests: its place in the limits (guard.h), its TLS session, and
 * responses on it.  On the I/O thread only. */
#ifndef SERVER_PEER_H
#define SERVER_PEER_H
#include <stdbool.h>
#include <gnutls/gnutls.h>
#include "guard.h"
#include "status.h"

struct MHD_Connection;
struct errinfo;
struct peer;
struct response;
struct tls;
struct tls_files;

/* What all connections share; borrowed until the last one is closed. */
struct peer_host {
    struct guard *guard;
    struct tls *tls; /* NULL: plain HTTP */
    /* refuse(arg, p, status): Responds by peer_respond_midbody().  Called when libmicrohttpd is about to refuse
     * by itself what p has sent; afterwards the connection sends no more. */
    void (*refuse)(void *arg, struct peer *p, unsigned status);
    void *arg; /* first argument of refuse() */
};

struct peer {
    const struct peer_host *host;
    struct guard_peer *place;
    struct MHD_Connection *conn;
    void *current; /* the current request, for refuse(); NULL: none */
    int fd;
    gnutls_session_t session; /* NULL: no TLS */
    struct tls_files *files;  /* certificate of the session */
};

/* peer_open(host, conn): Returns the peer of a new connection, whose TLS session gets the current certificate.
 * NULL: out of memory; then the connection is shut down. */
struct peer *peer_open(const struct peer_host *host, struct MHD_Connection *conn);

/* peer_close(p): Releases p; its socket is still open, its TLS session has ended.  NULL is allowed. */
void peer_close(struct peer *p);

/* peer_init(e): Prepares peer_respond().  ST_OK, ST_EINTERNAL. */
enum status peer_init(struct errinfo *e);

/* peer_respond(p, a, id, close): Queues a response.  Returns false if out of memory, or if the connection is
 * not ready for a response.
 *   a      its body is taken
 *   id     X-Request-Id
 *   close  the connection is closed behind it */
bool peer_respond(struct peer *p, struct response *a, const char *id, bool close);

/* peer_respond_midbody(p, a, id): Writes a response to the socket past libmicrohttpd, at any time; the caller
 * then closes the connection.  Returns true if the socket's buffer took all of it. */
bool peer_respond_midbody(struct peer *p, const struct response *a, const char *id);

#endif
