#include "digest.h"

#include <math.h>
#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "libsurface.h"

static int compare_points(const void *a, const void *b)
{
    const double *p = a, *q = b;

    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Of the points in the lattice's units, of which the face's millimetres are a thousand. */
enum status digest_points(const struct surface_face *f, char hex[65])
{
    const uint32_t n = surface_face_points(f, NULL);
    crypto_hash_sha256_state state;
    unsigned char hash[crypto_hash_sha256_BYTES], bytes[12];
    double(*mm)[3] = calloc(n != 0 ? n : 1, sizeof *mm);

    hex[0] = '\0';
    if (mm == NULL)
        return ST_ENOMEM;
    (void)surface_face_points(f, mm);
    qsort(mm, n, sizeof *mm, compare_points);
    (void)crypto_hash_sha256_init(&state);
    for (uint32_t v = 0; v < n; v++) {
        for (size_t k = 0; k < 3; k++)
            bytes_set(bytes + 4 * k, (uint32_t)lrint(1000 * mm[v][k]), 4);
        (void)crypto_hash_sha256_update(&state, bytes, sizeof bytes);
    }
    (void)crypto_hash_sha256_final(&state, hash);
    (void)sodium_bin2hex(hex, 65, hash, sizeof hash);
    free(mm);
    return ST_OK;
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
