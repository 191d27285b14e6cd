/* bytes.h -- numbers and texts as bytes, independent of machine and alignment: little-endian numbers, doubles
 * as their 64 bits, texts as their length in two bytes and their bytes. */
#ifndef BASE_BYTES_H
#define BASE_BYTES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* bytes_set(to, v, n): Writes the low n bytes of v, n <= 8. */
void bytes_set(unsigned char *to, uint64_t v, size_t n);

/* bytes_number(from, n): Returns the number in n bytes, n <= 8. */
uint64_t bytes_number(const unsigned char *from, size_t n);
double bytes_real(const unsigned char from[8]);

/* ---- writing in sequence: *to moves past the bytes written, for which the caller has room */

void bytes_put(unsigned char **to, const void *from, size_t n);
void bytes_put_number(unsigned char **to, uint64_t v, size_t n);
void bytes_put_real(unsigned char **to, double v);
void bytes_put_text(unsigned char **to, const char *text); /* shorter than 64 KB */

/* ---- reading in sequence: these return false if the bytes end too early, or if the value is not valid */

struct bytes {
    const unsigned char *at, *end;
};

bool bytes_get_number(struct bytes *b, size_t n, uint64_t *out);

/* bytes_get_finite(b, out): Reads a double that is finite. */
bool bytes_get_finite(struct bytes *b, double *out);

#endif
