/* merge.c -- b's points are inserted into a copy of a's triangulation along b's spanning
 * tree, each from the triangle in which it was located (insert.h).  Mestetskiy and Tsarik
 * trace the seams between two unseparated triangulations instead.  Where two scans of one face
 * overlap, three quarters of all triangles lie on a seam; insertion costs no more and has a
 * valid triangulation after every step.  Insertion alone would be quadratic on contrived
 * input, so the work is counted, and beyond a multiple of the points the union is triangulated
 * from scratch.  The Delaunay triangulation is unique (predicates.h), so both ways give the
 * same. */
#include "merge.h"

#include <stdbool.h>

#include "insert.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "delaunay.h"

/* Walk steps and new triangles per point, on average, before merge_build() starts from
 * scratch.  Two scans of a face need about 5; contrived input would need N. */
#define MERGE_WORK 40

/* Give the ghost its final number. */
static void name_ghost(struct mesh *m, uint32_t from, uint32_t to)
{
    const uint32_t first = m->out[from];
    uint32_t h = first;

    do {
        m->org[h] = to;
        h = mesh_turn(m, h);
    } while (h != first);
    m->out[to] = first;
}

/* Insert all of b; ST_ELIMIT when it took too much work. */
static enum status merge_grow(struct mesh *m, const struct mesh *a, const struct mesh *b,
                              const struct location *b_in_a, struct scratch *s,
                              uint32_t *b_vertex)
{
    const uint32_t ghost = a->nv + b->nv;
    struct insert in = {.m = m, .ghost = ghost, .limit = (uint64_t)MERGE_WORK * ghost};
    unsigned char *block = scratch_need(s, insert_start(&in, NULL));

    if (block == NULL)
        return ST_ENOMEM;
    (void)insert_start(&in, block);
    name_ghost(m, a->nv, ghost);
    for (uint32_t v = 0; v < b->nv; v++) {
        const struct ivec2 q = b->xy[v];
        uint32_t he = b_in_a[v].he;
        bool on_edge;

        if (b_in_a[v].where == LOCATE_VERTEX) {
            b_vertex[v] = a->org[he];
            continue;
        }
        if (!insert_find(&in, &he, q, &on_edge))
            return ST_ELIMIT;
        b_vertex[v] = m->nv;
        m->xy[m->nv] = q;
        m->z[m->nv] = b->z[v];
        insert_point(&in, he, on_edge, m->nv++);
    }
    if (m->nv != ghost)
        name_ghost(m, ghost, m->nv);
    return ST_OK;
}

/* Triangulate the union from scratch, with the vertex numbers that merge_grow() would give. */
static enum status rebuild(struct mesh *m, const struct mesh *a, const struct mesh *b,
                           const struct location *b_in_a, struct scratch *s,
                           uint32_t *b_vertex)
{
    const size_t n = (size_t)a->nv + b->nv;
    struct ivec3 *pts = mem_array(2 * n, sizeof *pts);
    uint32_t k = 0;
    enum status st;

    if (pts == NULL)
        return ST_ENOMEM;
    for (; k < a->nv; k++)
        pts[k] = (struct ivec3){a->xy[k].x, a->xy[k].y, a->z[k]};
    for (uint32_t v = 0; v < b->nv; v++) {
        if (b_in_a[v].where == LOCATE_VERTEX) {
            b_vertex[v] = a->org[b_in_a[v].he];
        } else {
            b_vertex[v] = k;
            pts[k++] = (struct ivec3){b->xy[v].x, b->xy[v].y, b->z[v]};
        }
    }
    st = delaunay_numbered(pts, k, s, m);
    mem_free(pts);
    return st;
}

enum status merge_build(const struct mesh *a, const struct mesh *b,
                        const struct location *b_in_a, struct scratch *s,
                        struct mesh *out, uint32_t *b_vertex)
{
    enum status st = mesh_copy(out, a, b->nv);

    if (st == ST_OK && (st = merge_grow(out, a, b, b_in_a, s, b_vertex)) == ST_ELIMIT)
        st = rebuild(out, a, b, b_in_a, s, b_vertex);
    if (st != ST_OK)
        out->nv = out->nt = 0;
    return st;
}
