#include "mesh.h"

#include <string.h>

#include "mem.h"

/* mesh_layout(n, m, block): point m's arrays into block for n points; returns the bytes
 * needed.  With block == NULL only the size is computed. */
static size_t mesh_layout(uint32_t n, struct mesh *m, unsigned char *block)
{
    const size_t points = n, halfedges = 6 * points;
    const size_t xy = 0;
    const size_t org = xy + mem_round(points * sizeof *m->xy);
    const size_t twin = org + mem_round(halfedges * sizeof *m->org);
    const size_t z = twin + mem_round(halfedges * sizeof *m->twin);
    const size_t out = z + mem_round(points * sizeof *m->z);
    const size_t parent = out + mem_round((points + 1) * sizeof *m->out);

    if (block != NULL) {
        m->xy = (struct ivec2 *)(void *)(block + xy);
        m->org = (uint32_t *)(void *)(block + org);
        m->twin = (uint32_t *)(void *)(block + twin);
        m->z = (int32_t *)(void *)(block + z);
        m->out = (uint32_t *)(void *)(block + out);
        m->parent = (uint32_t *)(void *)(block + parent);
    }
    return parent + mem_round(points * sizeof *m->parent);
}

enum status mesh_reserve(struct mesh *m, uint32_t n)
{
    unsigned char *block;

    if (n > MESH_MAX_POINTS)
        return ST_ELIMIT;
    if (m->block == NULL || n > m->cap) {
        if ((block = mem_array(mesh_layout(n, m, NULL), 1)) == NULL)
            return ST_ENOMEM;
        mem_free(m->block);
        m->block = block;
        m->cap = n;
        (void)mesh_layout(n, m, block);
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
