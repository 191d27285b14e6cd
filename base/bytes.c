#include "bytes.h"

#include <math.h>
#include <string.h>

void bytes_set(unsigned char *to, uint64_t v, size_t n)
{
    for (size_t i = 0; i < n; i++)
        to[i] = (unsigned char)(v >> 8 * i);
}

uint64_t bytes_number(const unsigned char *from, size_t n)
{
    uint64_t v = 0;

    for (size_t i = 0; i < n; i++)
        v |= (uint64_t)from[i] << 8 * i;
    return v;
}

double bytes_real(const unsigned char from[8])
{
    const uint64_t bits = bytes_number(from, 8);
    double v;

    memcpy(&v, &bits, sizeof v);
    return v;
}

void bytes_put(unsigned char **to, const void *from, size_t n)
{
    memcpy(*to, from, n);
    *to += n;
}

void bytes_put_number(unsigned char **to, uint64_t v, size_t n)
{
    bytes_set(*to, v, n);
    *to += n;
}

void bytes_put_real(unsigned char **to, double v)
{
    uint64_t bits;

    memcpy(&bits, &v, sizeof bits);
    bytes_put_number(to, bits, sizeof bits);
}

void bytes_put_text(unsigned char **to, const char *text)
{
    const size_t n = strlen(text);

    bytes_put_number(to, n, 2);
    bytes_put(to, text, n);
}

bool bytes_get_number(struct bytes *b, size_t n, uint64_t *out)
{
    *out = 0;
    if ((size_t)(b->end - b->at) < n)
        return false;
    *out = bytes_number(b->at, n);
    b->at += n;
    return true;
}

bool bytes_get_finite(struct bytes *b, double *out)
{
    if (b->end - b->at < 8)
        return false;
    *out = bytes_real(b->at);
    b->at += 8;
    return isfinite(*out);
}
