/* proxy_header.h -- the header that a proxy sends before the bytes of the connection that it forwards:
 * the PROXY protocol, version 2 (HAProxy's doc/proxy-protocol.txt, section 2.2). */
#ifndef SERVER_PROXY_HEADER_H
#define SERVER_PROXY_HEADER_H
#include <stddef.h>
#include <sys/socket.h>

/* Bytes of a header with all that follows the addresses (TLVs), as nginx takes it; HAProxy sends some
 * hundred at most, unless it adds certificates. */
#define PROXY_HEADER_MAX 4096

enum proxy_header_state { PROXY_HEADER_MORE, PROXY_HEADER_DONE, PROXY_HEADER_BAD };

struct proxy_header {
    size_t len; /* bytes that it has, as far as they tell: 16, then all */
    struct sockaddr_storage client; /* IPv4 or IPv6, with the port */
    socklen_t client_len; /* 0: it names none, and the connection's own address counts */
    const char *why;      /* of PROXY_HEADER_BAD: static text */
};

/* proxy_header_read(bytes, n, out): bytes[n] is the beginning of a connection, and nothing
 * beyond its header: n <= out->len of the call before, 16 at first.
 * PROXY_HEADER_MORE  out->len is set, and larger than n
 * PROXY_HEADER_DONE  n is out->len; client, client_len are set.  client_len is 0 for the command
 *                    LOCAL, as health checks have it, and for UNSPEC and Unix sockets
 * PROXY_HEADER_BAD   whatever may follow, it is none, malformed or too long; out->why is set */
enum proxy_header_state proxy_header_read(const unsigned char *bytes, size_t n,
                                          struct proxy_header *out);

#endif
