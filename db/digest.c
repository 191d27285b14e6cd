#include "digest.h"

#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>

#include "bytes.h"
#include "mesh.h"

static int compare_points(const void *a, const void *b)
{
    const struct ivec3 *p = a, *q = b;

    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return (p->y > q->y) - (p->y < q->y);
}

enum status digest_points(const struct mesh *m, char hex[65])
{
    crypto_hash_sha256_state state;
    unsigned char hash[crypto_hash_sha256_BYTES], point[12];
    struct ivec3 *pts = calloc(m->nv != 0 ? m->nv : 1, sizeof *pts);

    hex[0] = '\0';
    if (pts == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v++)
        pts[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
    qsort(pts, m->nv, sizeof *pts, compare_points);
    (void)crypto_hash_sha256_init(&state);
    for (uint32_t v = 0; v < m->nv; v++) {
        bytes_set(point, (uint32_t)pts[v].x, 4);
        bytes_set(point + 4, (uint32_t)pts[v].y, 4);
        bytes_set(point + 8, (uint32_t)pts[v].z, 4);
        (void)crypto_hash_sha256_update(&state, point, sizeof point);
    }
    (void)crypto_hash_sha256_final(&state, hash);
    (void)sodium_bin2hex(hex, 65, hash, sizeof hash);
    free(pts);
    return ST_OK;
}
