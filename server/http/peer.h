/* peer.h -- what is known of a connection beside its requests: its place in the limits
 * (guard.h), its TLS session, and sending on it.  On the I/O thread only. */
#ifndef SERVER_PEER_H
#define SERVER_PEER_H
#include <stdbool.h>
#include <stddef.h>
#include "guard.h"
#include "status.h"

struct MHD_Connection;
struct errinfo;
struct peer;
struct response;
struct tls;

/* What all connections share; borrowed until the last one is closed. */
struct peer_host {
    struct guard *guard;
    struct tls *tls; /* NULL: plain HTTP */
    /* refuse(arg, p, current, status): libmicrohttpd is about to refuse what p has sent.  Respond by
     * peer_respond_midbody(): the connection sends no more then.  current: of peer_set_current(). */
    void (*refuse)(void *arg, struct peer *p, void *current, unsigned status);
    void *arg;
};

/* peer_open(host, conn): conn has just begun; with TLS its session gets the certificate in
 * force.  NULL: out of memory, and the connection is shut down. */
struct peer *peer_open(const struct peer_host *host, struct MHD_Connection *conn);

/* peer_close(p): called while p's socket is still open, but its TLS session has ended.  NULL is
 * allowed. */
void peer_close(struct peer *p);

/* peer_begin(p, step): guard_begin(); peer_more(p, bytes): guard_more(). */
void peer_begin(struct peer *p, enum guard_step step);
void peer_more(struct peer *p, size_t bytes);

/* peer_work(p, gone, arg): GUARD_WORK, as guard_work(). */
void peer_work(struct peer *p, void (*gone)(void *arg), void *arg);

int peer_socket(const struct peer *p);

/* peer_set_current(p, current): what host->refuse() gets; NULL: nothing. */
void peer_set_current(struct peer *p, void *current);

/* peer_init(e): before the first peer_respond().  ST_OK, ST_EINTERNAL. */
enum status peer_init(struct errinfo *e);

/* peer_respond(p, a, id, close): queue the response, whose body is taken; id: X-Request-Id;
 * close: the connection ends with it.  False: no memory, or the connection is not ready for
 * one. */
bool peer_respond(struct peer *p, struct response *a, const char *id, bool close);

/* peer_respond_midbody(p, a, id): writes the response past libmicrohttpd, at any time; the connection
 * must be closed afterwards.  True: all of it went into the socket's buffer. */
bool peer_respond_midbody(struct peer *p, const struct response *a, const char *id);

#endif
