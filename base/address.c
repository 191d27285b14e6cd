#include "address.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/un.h>

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

static bool read_path(const char *path, struct sockaddr_storage *out, socklen_t *len)
{
    struct sockaddr_un un = {.sun_family = AF_UNIX};
    const size_t n = strlen(path);

    if (n == 0 || n >= sizeof un.sun_path)
        return false;
    memcpy(un.sun_path, path, n + 1);
    memset(out, 0, sizeof *out);
    memcpy(out, &un, sizeof un);
    *len = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + n + 1);
    return true;
}

bool address_read(const char *text, struct sockaddr_storage *out, socklen_t *len)
{
    const char *colon = strrchr(text, ':');
    struct sockaddr_in in = {.sin_family = AF_INET};
    struct sockaddr_in6 in6 = {.sin6_family = AF_INET6};
    char host[64];
    in_port_t port;
    size_t n;

    if (strncmp(text, "unix:", 5) == 0)
        return read_path(text + 5, out, len);
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

/* Writes the address as one of IPv6, among which IPv4 is ::ffff:0:0/96.  Returns false for NULL and for
 * other families. */
static bool as_ipv6(const struct sockaddr *sa, struct in6_addr *out)
{
    struct sockaddr_in6 in6;
    struct sockaddr_in in;

    if (sa != NULL && sa->sa_family == AF_INET) {
        memcpy(&in, sa, sizeof in);
        *out = (struct in6_addr){.s6_addr = {[10] = 0xff, [11] = 0xff}};
        memcpy(&out->s6_addr[12], &in.sin_addr, 4);
        return true;
    }
    if (sa == NULL || sa->sa_family != AF_INET6)
        return false;
    memcpy(&in6, sa, sizeof in6);
    *out = in6.sin6_addr;
    return true;
}

bool address_is_local(const struct sockaddr *sa)
{
    struct in6_addr a;

    if (!as_ipv6(sa, &a))
        return sa != NULL && sa->sa_family == AF_UNIX;
    return IN6_IS_ADDR_V4MAPPED(&a) ? a.s6_addr[12] == 127
                                    : IN6_IS_ADDR_LOOPBACK(&a) != 0;
}

/* No client has the multicast address ff00::, nor any other with its first byte. */
uint64_t address_key(const struct sockaddr *sa)
{
    struct in6_addr a;
    uint64_t key = 0;

    if (!as_ipv6(sa, &a))
        return ADDRESS_NO_KEY;
    if (IN6_IS_ADDR_V4MAPPED(&a))
        a = (struct in6_addr){.s6_addr = {0xff, 0, 0, 0, a.s6_addr[12], a.s6_addr[13],
                                          a.s6_addr[14], a.s6_addr[15]}};
    for (int i = 0; i < 8; i++)
        key = key << 8 | a.s6_addr[i];
    return key;
}

const char *address_path(const struct sockaddr_storage *ss)
{
    return ss->ss_family == AF_UNIX
               ? (const char *)ss + offsetof(struct sockaddr_un, sun_path)
               : NULL;
}

void address_host(const struct sockaddr *sa, char host[ADDRESS_HOST_MAX])
{
    struct in6_addr a;

    host[0] = '\0';
    if (!as_ipv6(sa, &a))
        (void)snprintf(host, ADDRESS_HOST_MAX, "%s",
                       sa != NULL && sa->sa_family == AF_UNIX ? "unix" : "");
    else if (IN6_IS_ADDR_V4MAPPED(&a))
        (void)inet_ntop(AF_INET, &a.s6_addr[12], host, ADDRESS_HOST_MAX);
    else
        (void)inet_ntop(AF_INET6, &a, host, ADDRESS_HOST_MAX);
}

void address_url(const struct sockaddr_storage *ss, bool tls, char url[ADDRESS_URL_MAX])
{
    const char *scheme = tls ? "https" : "http";
    char host[INET6_ADDRSTRLEN] = "";

    if (ss->ss_family == AF_INET6) {
        struct sockaddr_in6 in6;

        memcpy(&in6, ss, sizeof in6);
        (void)inet_ntop(AF_INET6, &in6.sin6_addr, host, sizeof host);
        (void)snprintf(url, ADDRESS_URL_MAX, "%s://[%s]:%u", scheme, host,
                       ntohs(in6.sin6_port));
    } else if (ss->ss_family == AF_INET) {
        struct sockaddr_in in;

        memcpy(&in, ss, sizeof in);
        (void)inet_ntop(AF_INET, &in.sin_addr, host, sizeof host);
        (void)snprintf(url, ADDRESS_URL_MAX, "%s://%s:%u", scheme, host,
                       ntohs(in.sin_port));
    } else {
        (void)snprintf(url, ADDRESS_URL_MAX, "unix:%s", address_path(ss));
    }
}

/* ---- lists */

/* A prefix of IPv6 addresses, among which IPv4 is ::ffff:0:0/96; or all Unix sockets. */
struct network {
    int family; /* AF_INET6, AF_UNIX */
    unsigned char prefix[16];
    unsigned bits;
};

static bool read_bits(const char *s, unsigned most, unsigned *out)
{
    const unsigned long n = strtoul(s, NULL, 10);
    const size_t digits = strspn(s, "0123456789");

    *out = (unsigned)n;
    return digits > 0 && digits <= 3 && s[digits] == '\0' && n <= most;
}

static bool no_bit_beyond(const struct network *w)
{
    for (unsigned i = w->bits; i < 128; i++)
        if ((w->prefix[i / 8] >> (7 - i % 8) & 1) != 0)
            return false;
    return true;
}

/* The first of the list.  *next: behind its comma; NULL: it was the last. */
static bool read_network(const char *list, struct network *out, const char **next)
{
    static const unsigned char ipv4[12] = {[10] = 0xff, [11] = 0xff};
    const size_t n = strcspn(list, ",");
    char text[64], *slash;
    unsigned most = 128;

    *next = list[n] == ',' ? list + n + 1 : NULL;
    if (n >= sizeof text)
        return false;
    memcpy(text, list, n);
    text[n] = '\0';
    *out = (struct network){.family = AF_UNIX};
    if (strcmp(text, "unix") == 0)
        return true;
    out->family = AF_INET6;
    if ((slash = strchr(text, '/')) != NULL)
        *slash = '\0';
    if (inet_pton(AF_INET, text, out->prefix + sizeof ipv4) == 1) {
        memcpy(out->prefix, ipv4, sizeof ipv4);
        most = 32;
    } else if (inet_pton(AF_INET6, text, out->prefix) != 1) {
        return false;
    }
    out->bits = most;
    if (slash != NULL && !read_bits(slash + 1, most, &out->bits))
        return false;
    out->bits += 128 - most;
    return no_bit_beyond(out);
}

bool address_is_list(const char *list)
{
    struct network w;

    while (list != NULL)
        if (!read_network(list, &w, &list))
            return false;
    return true;
}

/* As a network of one address. */
static bool network_of(const struct sockaddr *sa, struct network *out)
{
    char host[ADDRESS_HOST_MAX];
    const char *end;

    address_host(sa, host);
    return read_network(host, out, &end);
}

static bool is_within(const struct network *one, const struct network *w)
{
    const unsigned whole = w->bits / 8, rest = w->bits % 8;

    return one->family == w->family && memcmp(one->prefix, w->prefix, whole) == 0 &&
           (rest == 0 || (one->prefix[whole] ^ w->prefix[whole]) >> (8 - rest) == 0);
}

bool address_in_list(const char *list, const struct sockaddr *sa)
{
    struct network one, w;

    if (!network_of(sa, &one))
        return false;
    while (list != NULL)
        if (read_network(list, &w, &list) && is_within(&one, &w))
            return true;
    return false;
}
