#include "peer.h"

#include <stdlib.h>
#include <sys/socket.h>
#include <microhttpd.h>

#include "tls.h"

struct peer {
    const struct peer_host *host;
    struct guard_peer *place;
    int fd;
    gnutls_session_t session; /* NULL: no TLS */
    struct tls_files *files;
};

struct peer *peer_open(const struct peer_host *host, struct MHD_Connection *conn)
{
    const int fd =
        MHD_get_connection_info(conn, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
    const struct sockaddr *addr =
        MHD_get_connection_info(conn, MHD_CONNECTION_INFO_CLIENT_ADDRESS)->client_addr;
    struct peer *p = calloc(1, sizeof *p);

    if (p != NULL)
        p->place = guard_open(host->guard, fd, addr);
    if (p == NULL || p->place == NULL) { /* and nothing would ever end it */
        (void)shutdown(fd, SHUT_RDWR);
        free(p);
        return NULL;
    }
    p->host = host;
    p->fd = fd;
    if (host->tls != NULL) {
        p->session = MHD_get_connection_info(conn, MHD_CONNECTION_INFO_GNUTLS_SESSION)
                         ->tls_session;
        p->files = tls_attach(host->tls, p->session);
    }
    return p;
}

void peer_close(struct peer *p)
{
    if (p == NULL)
        return;
    guard_close(p->host->guard, p->place);
    tls_detach(p->files);
    free(p);
}

void peer_begin(struct peer *p, enum guard_step step, size_t bytes)
{
    guard_begin(p->host->guard, p->place, step);
    guard_more(p->host->guard, p->place, bytes);
}

void peer_more(struct peer *p, size_t bytes)
{
    guard_more(p->host->guard, p->place, bytes);
}

int peer_socket(const struct peer *p)
{
    return p->fd;
}

bool peer_send(const struct peer *p, const void *data, size_t len)
{
    if (p->session != NULL)
        return tls_send(p->session, data, len) == (ssize_t)len;
    return send(p->fd, data, len, MSG_NOSIGNAL | MSG_DONTWAIT) == (ssize_t)len;
}
