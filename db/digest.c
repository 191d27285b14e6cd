#include "digest.h"

#include <math.h>
#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "cloudpoints.h"
#include "libsurface.h"

#define DIGIT_BITS 11
#define DIGITS     (1U << DIGIT_BITS)

/* ---- of a face */

/* A point in lattice units, moved so that no coordinate is negative. */
struct spot {
    uint32_t at[3];
};

/* Sorts the n elements of a by one axis, stably, with the help of b.  Returns the array that has the
 * result: a or b.  (qsort() would take a tenth of an enrolment.) */
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

/* Returns a coordinate in lattice units, 1000 to a millimetre. */
static int32_t unit(double mm)
{
    return (int32_t)lrint(1000 * mm);
}

enum status digest_face(const struct surface_face *f, char hex[65])
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

/* ---- of a scan, as it was read */

/* The digest covers the SAMPLE points whose own hash is least: a sample that depends on the set alone
 * (Broder 1997, section 3).  The lattice has 1/500 of the cloud's greatest coordinate, some 0.2 mm: so
 * coarse that few points move on it if a format keeps fewer decimals.  Two scans by one scanner share
 * many points of this lattice, but never the whole sample. */
#define SAMPLE 32
#define UNITS  500.0 /* of the lattice, to the greatest coordinate */
#define FAR    1e15
#define HALF   1024 /* lattice units: more than any coordinate */

/* Returns the number of lattice units in a unit of the file; 0: c is no cloud of an object. */
static double scale_of(const struct cloudpoints *c)
{
    double most = 0;

    for (size_t i = 0; i < c->n; i++)
        most =
            fmax(most, fmax(fabs(c->at[i].x), fmax(fabs(c->at[i].y), fabs(c->at[i].z))));
    return most > 1 / FAR && most < FAR ? UNITS / most : 0;
}

/* Returns a coordinate on the lattice; 0 if it is no number, or beyond the lattice: such a cloud is
 * refused. */
static uint64_t place_of(double at)
{
    return fabs(at) <= HALF ? (uint64_t)(at + HALF + 0.5) : 0;
}

/* Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators", mix64(): one to
 * one, so that different points have different hashes. */
static uint64_t hash_of(const struct dvec3 *p, double scale)
{
    uint64_t h = place_of(p->x * scale) << 42 ^ place_of(p->y * scale) << 21 ^
                 place_of(p->z * scale);

    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9U;
    h = (h ^ h >> 27) * 0x94d049bb133111ebU;
    return h ^ h >> 31;
}

/* Inserts hash into least[0..n-1], which ascends and has room for SAMPLE, unless it is there already.
 * Returns the new n. */
static size_t insert(uint64_t *least, size_t n, uint64_t hash)
{
    size_t i = n;

    while (i > 0 && least[i - 1] > hash)
        i--;
    if (i > 0 && least[i - 1] == hash)
        return n;
    if (n == SAMPLE)
        n--; /* the last one goes */
    memmove(&least[i + 1], &least[i], (n - i) * sizeof *least);
    least[i] = hash;
    return n + 1;
}

void digest_scan(const struct cloudpoints *c, char hex[65])
{
    unsigned char hash[crypto_hash_sha256_BYTES];
    uint64_t least[SAMPLE] = {0};
    const double scale = scale_of(c);
    size_t n = 0;

    for (size_t i = 0; i < c->n; i++) {
        const uint64_t h = hash_of(&c->at[i], scale);

        if (n < SAMPLE || h < least[n - 1])
            n = insert(least, n, h);
    }
    (void)crypto_hash_sha256(hash, (const unsigned char *)least, sizeof least);
    (void)sodium_bin2hex(hex, 65, hash, sizeof hash);
}

/* ---- of the scans of a template */

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
