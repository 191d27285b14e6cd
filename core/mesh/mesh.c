#include "mesh.h"

#include <string.h>

#include "mem.h"

/* m's arrays in block for n points; returns the bytes needed. */
static size_t layout(struct mesh *m, size_t n, unsigned char *block)
{
    size_t at = 0;

    m->xy = mem_take(block, &at, n + 1, sizeof *m->xy);
    m->org = mem_take(block, &at, 6 * n, sizeof *m->org);
    m->twin = mem_take(block, &at, 6 * n, sizeof *m->twin);
    m->z = mem_take(block, &at, n, sizeof *m->z);
    m->out = mem_take(block, &at, n + 1, sizeof *m->out);
    m->parent = mem_take(block, &at, n, sizeof *m->parent);
    return at;
}

enum status mesh_reserve(struct mesh *m, uint32_t n)
{
    struct mesh larger = {0};

    if (n > MESH_MAX_POINTS)
        return ST_ELIMIT;
    if (m->block == NULL || n > m->cap) {
        if ((larger.block = mem_array(layout(&larger, n, NULL), 1)) == NULL)
            return ST_ENOMEM;
        (void)layout(&larger, n, larger.block);
        larger.cap = n;
        mem_free(m->block);
        *m = larger;
    }
    m->nv = m->nt = 0;
    return ST_OK;
}

uint32_t mesh_real(const struct mesh *m)
{
    uint32_t ghosts = 0;

    for (uint32_t h = 0; h < 3 * m->nt; h++)
        ghosts += m->org[h] == m->nv; /* each ghost has one such corner */
    return m->nt - ghosts;
}

void mesh_free(struct mesh *m)
{
    if (m == NULL)
        return;
    mem_free(m->block);
    memset(m, 0, sizeof *m);
}

enum status mesh_copy(struct mesh *dst, const struct mesh *src, uint32_t extra)
{
    const size_t n = src->nv, h = 3 * (size_t)src->nt;
    enum status st;

    if (extra > MESH_MAX_POINTS - src->nv)
        return ST_ELIMIT;
    if ((st = mesh_reserve(dst, src->nv + extra)) != ST_OK)
        return st;
    dst->nv = src->nv;
    dst->nt = src->nt;
    memcpy(dst->xy, src->xy, n * sizeof *src->xy);
    memcpy(dst->z, src->z, n * sizeof *src->z);
    memcpy(dst->org, src->org, h * sizeof *src->org);
    memcpy(dst->twin, src->twin, h * sizeof *src->twin);
    memcpy(dst->out, src->out, (n + 1) * sizeof *src->out);
    memcpy(dst->parent, src->parent, n * sizeof *src->parent);
    return ST_OK;
}
