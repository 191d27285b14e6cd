/* The beginnings of a proxy's connections.  However the bytes come in parts, the outcome is the same,
 * and no more is asked for than the header has. */
#include "fuzz.h"

#include <string.h>

#include "proxy_header.h"

/* As proxy.c reads it, at most step bytes at a time.  PROXY_HEADER_MORE: the data ends before. */
static enum proxy_header_state read_by(const uint8_t *data, size_t size, size_t step,
                                       struct proxy_header *out)
{
    enum proxy_header_state st;
    size_t n = 0;

    while ((st = proxy_header_read(data, n, out)) == PROXY_HEADER_MORE && n < size) {
        require(out->len > n && out->len <= PROXY_HEADER_MAX);
        n += out->len - n < step ? out->len - n : step;
        n = n < size ? n : size;
    }
    require(st != PROXY_HEADER_DONE || out->len == n);
    return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct proxy_header whole, parts;
    const enum proxy_header_state st = read_by(data, size, PROXY_HEADER_MAX, &whole);

    require(read_by(data, size, 1, &parts) == st);
    switch (st) {
    case PROXY_HEADER_MORE:
        require(size < whole.len);
        break;
    case PROXY_HEADER_BAD:
        require(whole.why != NULL);
        break;
    case PROXY_HEADER_DONE:
        require(whole.len == parts.len && whole.client_len == parts.client_len &&
                memcmp(&whole.client, &parts.client, sizeof whole.client) == 0);
        require(whole.client_len == 0 ? whole.client.ss_family == AF_UNSPEC
                                      : whole.client.ss_family == AF_INET ||
                                            whole.client.ss_family == AF_INET6);
    }
    return 0;
}
