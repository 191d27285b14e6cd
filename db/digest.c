#include "digest.h"

#include <math.h>
#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>

#include "bytes.h"
#include "libsurface.h"

/* In the lattice's units, of which the face's millimetres are a thousand: exactly. */
struct point {
    int32_t at[3];
};

static int compare_points(const void *a, const void *b)
{
    const int32_t *p = ((const struct point *)a)->at, *q = ((const struct point *)b)->at;

    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

enum status digest_points(const struct surface_face *f, char hex[65])
{
    const uint32_t n = surface_face_points(f, NULL);
    crypto_hash_sha256_state state;
    unsigned char hash[crypto_hash_sha256_BYTES], bytes[12];
    struct point *pts = calloc(n != 0 ? n : 1, sizeof *pts);
    double(*mm)[3] = calloc(n != 0 ? n : 1, sizeof *mm);

    hex[0] = '\0';
    if (pts == NULL || mm == NULL) {
        free(pts);
        free(mm);
        return ST_ENOMEM;
    }
    (void)surface_face_points(f, mm);
    for (uint32_t v = 0; v < n; v++)
        for (int k = 0; k < 3; k++)
            pts[v].at[k] = (int32_t)lrint(1000 * mm[v][k]);
    qsort(pts, n, sizeof *pts, compare_points);
    (void)crypto_hash_sha256_init(&state);
    for (uint32_t v = 0; v < n; v++) {
        for (size_t k = 0; k < 3; k++)
            bytes_set(bytes + 4 * k, (uint32_t)pts[v].at[k], 4);
        (void)crypto_hash_sha256_update(&state, bytes, sizeof bytes);
    }
    (void)crypto_hash_sha256_final(&state, hash);
    (void)sodium_bin2hex(hex, 65, hash, sizeof hash);
    free(pts);
    free(mm);
    return ST_OK;
}
