#include "digest.h"

#include <math.h>
#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "libsurface.h"

#define DIGIT_BITS 11
#define DIGITS     (1U << DIGIT_BITS)

/* A point in lattice units, so far from the least of each axis that it is positive. */
struct spot {
    uint32_t at[3];
};

/* Sorts a by one axis, those that are alike in their order; b is as long.  Returns the sorted one. */
static struct spot *sort_along(int axis, struct spot *a, struct spot *b, uint32_t n)
{
    for (int shift = 0; shift < 32; shift += DIGIT_BITS) {
        struct spot *const swap = a;
        uint32_t from[DIGITS] = {0}, sum = 0;

        for (uint32_t i = 0; i < n; i++)
            from[a[i].at[axis] >> shift & (DIGITS - 1)]++;
        if (n > 0 && from[a[0].at[axis] >> shift & (DIGITS - 1)] == n)
            continue;
        for (uint32_t d = 0; d < DIGITS; d++) {
            const uint32_t here = from[d];

            from[d] = sum;
            sum += here;
        }
        for (uint32_t i = 0; i < n; i++)
            b[from[a[i].at[axis] >> shift & (DIGITS - 1)]++] = a[i];
        a = b;
        b = swap;
    }
    return a;
}

/* Whole numbers of lattice units, of which the face's millimetres are a thousand. */
static int32_t unit(double mm)
{
    return (int32_t)lrint(1000 * mm);
}

/* Points by x, then y, of which no two are the same. */
enum status digest_points(const struct surface_face *f, char hex[65])
{
    const uint32_t n = surface_face_points(f, NULL);
    const uint32_t half = UINT32_C(1) << 31; /* more than any coordinate */
    unsigned char hash[crypto_hash_sha256_BYTES], *bytes;
    double(*mm)[3] = calloc(n + 1, sizeof *mm);
    struct spot *a = calloc(2 * (size_t)n + 1, sizeof *a);
    enum status st = ST_ENOMEM;

    hex[0] = '\0';
    if (mm != NULL && a != NULL) {
        struct spot *sorted;

        (void)surface_face_points(f, mm);
        for (uint32_t v = 0; v < n; v++)
            for (size_t k = 0; k < 3; k++)
                a[v].at[k] = (uint32_t)unit(mm[v][k]) + half;
        sorted = sort_along(1, a, a + n, n);
        sorted = sort_along(0, sorted, sorted == a ? a + n : a, n);
        bytes = (unsigned char *)mm;
        for (uint32_t v = 0; v < n; v++)
            for (size_t k = 0; k < 3; k++)
                bytes_set(bytes + 12 * (size_t)v + 4 * k, sorted[v].at[k] - half, 4);
        (void)crypto_hash_sha256(hash, bytes, 12 * (size_t)n);
        (void)sodium_bin2hex(hex, 65, hash, sizeof hash);
        st = ST_OK;
    }
    free(a);
    free(mm);
    return st;
}

void digest_read_add(char read[STORE_READ_MAX + 1], const char *digest)
{
    const size_t len = strlen(read), more = len == 0 ? 64 : STORE_READ_OTHER;

    if (len + more > STORE_READ_MAX || strlen(digest) < more)
        return;
    memcpy(read + len, digest, more);
    read[len + more] = '\0';
}

bool digest_read_has(const char *read, const char *digest)
{
    const size_t len = strlen(read);

    if (len < 64 || strlen(digest) < 64)
        return false;
    if (memcmp(read, digest, 64) == 0)
        return true;
    for (size_t at = 64; at + STORE_READ_OTHER <= len; at += STORE_READ_OTHER)
        if (memcmp(read + at, digest, STORE_READ_OTHER) == 0)
            return true;
    return false;
}
