#include "address.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static bool read_port(const char *s, in_port_t *out)
{
    unsigned long port;
    char *end;

    if (*s < '0' || *s > '9')
        return false;
    errno = 0;
    port = strtoul(s, &end, 10);
    *out = htons((uint16_t)port);
    return errno == 0 && *end == '\0' && port <= UINT16_MAX;
}

bool address_read(const char *text, struct sockaddr_storage *out, socklen_t *len)
{
    const char *colon = strrchr(text, ':');
    struct sockaddr_in in = {.sin_family = AF_INET};
    struct sockaddr_in6 in6 = {.sin6_family = AF_INET6};
    char host[64];
    in_port_t port;
    size_t n;

    if (colon == NULL || !read_port(colon + 1, &port))
        return false;
    n = (size_t)(colon - text);
    if (n == 0 || n >= sizeof host)
        return false;
    memcpy(host, text, n);
    host[n] = '\0';
    memset(out, 0, sizeof *out);
    if (host[0] == '[' && host[n - 1] == ']') {
        host[n - 1] = '\0';
        in6.sin6_port = port;
        if (inet_pton(AF_INET6, host + 1, &in6.sin6_addr) != 1)
            return false;
        memcpy(out, &in6, sizeof in6);
        *len = sizeof in6;
        return true;
    }
    in.sin_port = port;
    if (inet_pton(AF_INET, strcmp(host, "localhost") == 0 ? "127.0.0.1" : host,
                  &in.sin_addr) != 1)
        return false;
    memcpy(out, &in, sizeof in);
    *len = sizeof in;
    return true;
}

bool address_is_loopback(const struct sockaddr_storage *ss)
{
    if (ss->ss_family == AF_INET) {
        struct sockaddr_in in;

        memcpy(&in, ss, sizeof in);
        return (ntohl(in.sin_addr.s_addr) >> 24) == 127;
    } else {
        struct sockaddr_in6 in6;

        memcpy(&in6, ss, sizeof in6);
        return IN6_IS_ADDR_LOOPBACK(&in6.sin6_addr) != 0;
    }
}
