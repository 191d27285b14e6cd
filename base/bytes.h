/* bytes.h -- numbers and texts as bytes, the same on every machine and at any address:
 * numbers are little-endian, doubles their 64 bits, a text is its length in two bytes and
 * its bytes. */
#ifndef BASE_BYTES_H
#define BASE_BYTES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* bytes_set(to, v, n), bytes_number(from, n): the low n bytes (<= 8) of v. */
void bytes_set(unsigned char *to, uint64_t v, size_t n);
uint64_t bytes_number(const unsigned char *from, size_t n);
double bytes_real(const unsigned char from[8]);

/* ---- writing in sequence: *to moves past what was put; the caller has room for it */

void bytes_put(unsigned char **to, const void *from, size_t n);
void bytes_put_number(unsigned char **to, uint64_t v, size_t n);
void bytes_put_real(unsigned char **to, double v);
void bytes_put_text(unsigned char **to, const char *text); /* shorter than 64 KB */

/* ---- reading in sequence: false where the bytes end before, or the value is not
 * valid */

struct bytes {
    const unsigned char *at, *end;
};

bool bytes_get(struct bytes *b, void *to, size_t n);
bool bytes_get_number(struct bytes *b, size_t n, uint64_t *out);

bool bytes_get_finite(struct bytes *b, double *out); /* any number that is finite */

#endif
