#include "proxy_header.h"

#include <netinet/in.h>
#include <string.h>

/* Offsets of the fields.  The addresses are: source, destination, source port, destination port. */
enum { COMMAND = 12, FAMILY = 13, LENGTH = 14, ADDRESSES = 16 };
enum { LOCAL, PROXY };
enum { UNSPEC, INET, INET6, UNIX, FAMILIES };
#define TRANSPORTS 3 /* unspecified, stream, datagram (as of QUIC) */

static const unsigned char signature[COMMAND] = {'\r', '\n', '\r', '\n', '\0', '\r',
                                                 '\n', 'Q',  'U',  'I',  'T',  '\n'};
static const char version_1[] = {'P', 'R', 'O', 'X', 'Y'};
static const size_t size[FAMILIES] = {[INET] = 12, [INET6] = 36, [UNIX] = 216};

/* NULL: nothing is wrong with the n bytes that are there. */
static const char *find_fault(const unsigned char *bytes, size_t n)
{
    if (n >= sizeof version_1 && memcmp(bytes, version_1, sizeof version_1) == 0)
        return "version 1 of the PROXY protocol";
    if (memcmp(bytes, signature, n < COMMAND ? n : COMMAND) != 0)
        return "no PROXY protocol header";
    if (n > COMMAND && bytes[COMMAND] >> 4 != 2)
        return "unknown version of the PROXY protocol";
    if (n > COMMAND && (bytes[COMMAND] & 15) > PROXY)
        return "unknown command";
    if (n > FAMILY && (bytes[COMMAND] & 15) == PROXY &&
        (bytes[FAMILY] >> 4 >= FAMILIES || (bytes[FAMILY] & 15) >= TRANSPORTS))
        return "unknown address family or transport";
    return NULL;
}

static void take_client(const unsigned char *at, unsigned family, struct proxy_header *h)
{
    struct sockaddr_in in = {.sin_family = AF_INET};
    struct sockaddr_in6 in6 = {.sin6_family = AF_INET6};

    if (family == INET) {
        memcpy(&in.sin_addr, at, 4);
        memcpy(&in.sin_port, at + 8, 2);
        memcpy(&h->client, &in, sizeof in);
        h->client_len = sizeof in;
    } else if (family == INET6) {
        memcpy(&in6.sin6_addr, at, 16);
        memcpy(&in6.sin6_port, at + 32, 2);
        memcpy(&h->client, &in6, sizeof in6);
        h->client_len = sizeof in6;
    }
}

enum proxy_header_state proxy_header_read(const unsigned char *bytes, size_t n,
                                          struct proxy_header *h)
{
    unsigned family;

    *h = (struct proxy_header){.len = ADDRESSES, .why = find_fault(bytes, n)};
    if (h->why != NULL)
        return PROXY_HEADER_BAD;
    if (n < ADDRESSES)
        return PROXY_HEADER_MORE;
    h->len += (size_t)bytes[LENGTH] << 8 | bytes[LENGTH + 1];
    /* what LOCAL says of the family is ignored, and a family without its transport means nothing */
    family = (bytes[COMMAND] & 15) == LOCAL || (bytes[FAMILY] & 15) == 0
                 ? UNSPEC
                 : bytes[FAMILY] >> 4;
    if (h->len > PROXY_HEADER_MAX)
        h->why = "the header is too long";
    else if (h->len < ADDRESSES + size[family])
        h->why = "the header is shorter than its addresses";
    if (h->why != NULL)
        return PROXY_HEADER_BAD;
    if (n < h->len)
        return PROXY_HEADER_MORE;
    take_client(bytes + ADDRESSES, family, h);
    return PROXY_HEADER_DONE;
}
