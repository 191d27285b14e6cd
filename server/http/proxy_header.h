/* proxy_header.h -- the header that a proxy sends before the bytes of a forwarded connection: the PROXY protocol,
 * version 2 (HAProxy's doc/proxy-protocol.txt, section 2.2). */
#ifndef SERVER_PROXY_HEADER_H
#define SERVER_PROXY_HEADER_H
#include <stddef.h>
#include <sys/socket.h>

/* Limit of a header with its TLVs, bytes; nginx has the same.  HAProxy sends some hundred bytes at most, unless it
 * adds certificates. */
#define PROXY_HEADER_MAX 4096

enum proxy_header_state { PROXY_HEADER_MORE, PROXY_HEADER_DONE, PROXY_HEADER_BAD };

struct proxy_header {
    size_t len; /* bytes of the header as far as known: 16 at first, then all */
    struct sockaddr_storage client; /* client's address, IPv4 or IPv6, with the port */
    socklen_t
        client_len;  /* 0: no address is given, the connection's own address counts */
    const char *why; /* reason of PROXY_HEADER_BAD; static text */
};

/* proxy_header_read(bytes, n, out): Reads the beginning of a connection.
 *   bytes  n bytes of the header, none behind it
 *   n      at most out->len of the previous call; at most 16 in the first call
 * PROXY_HEADER_MORE  out->len is set, and larger than n
 * PROXY_HEADER_DONE  n is out->len; client and client_len are set.  client_len is 0 for the command
 *                    LOCAL, as in health checks, and for UNSPEC and Unix sockets
 * PROXY_HEADER_BAD   no header, a malformed one, or one that is too long; out->why is set */
enum proxy_header_state proxy_header_read(const unsigned char *bytes, size_t n,
                                          struct proxy_header *out);

#endif
