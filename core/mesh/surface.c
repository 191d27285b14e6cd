#include "surface.h"

#include <string.h>

#include "delaunay.h"
#include "holes.h"
#include "lattice.h"
#include "mem.h"
#include "mst.h"
#include "repair.h"
#include "spikes.h"

/* s's arrays in block for n points; returns the bytes needed. */
static size_t surface_layout(struct surface *s, size_t n, unsigned char *block)
{
    size_t at = 0;

    s->spacing = mem_take(block, &at, n, sizeof *s->spacing);
    s->bridge = mem_take(block, &at, 2 * n, sizeof *s->bridge);
    return at;
}

/* Room for the arrays of n points; their content is lost. */
static enum status reserve(struct surface *s, uint32_t n)
{
    struct surface larger = {0};

    if (s->block == NULL || s->cap < n) {
        if ((larger.block = mem_array(surface_layout(&larger, n, NULL), 1)) == NULL)
            return ST_ENOMEM;
        mem_free(s->block);
        s->block = larger.block;
        s->cap = n;
    }
    (void)surface_layout(s, n, s->block);
    return ST_OK;
}

enum status surface_derive(struct surface *out, struct scratch *s)
{
    const struct mesh *m = &out->mesh;
    enum status st = reserve(out, m->nv);

    if (st != ST_OK || (st = holes_spacing(m, s, out->spacing)) != ST_OK)
        return st;
    out->measured = holes_mark(m, out->spacing, out->bridge);
    out->spikes = 0;
    return ST_OK;
}

enum status surface_prepare(const struct ivec3 *pts, size_t n, bool flatten,
                            struct scratch *s, struct surface *out)
{
    struct mesh *m = &out->mesh;
    enum status st = delaunay_build(pts, n, s, m);

    if (st == ST_OK)
        st = mst_build(m, s);
    if (st == ST_OK)
        st = surface_derive(out, s);
    if (st == ST_OK && flatten)
        st = spikes_flatten(m, s, &out->spikes);
    if (st != ST_OK)
        m->nv = m->nt = 0;
    return st;
}

/* Points that are moved at a time, in a buffer on the stack. */
#define BATCH 128

/* The points of `from`, moved, become those of m. */
static enum status surface_place(const struct mesh *from, const double transform[16],
                                 struct mesh *m)
{
    for (uint32_t first = 0; first < from->nv; first += BATCH) {
        const uint32_t left = from->nv - first, n = left < BATCH ? left : BATCH;
        struct dvec3 p[BATCH];
        struct ivec3 q[BATCH];

        for (uint32_t i = 0; i < n; i++)
            p[i] = vec_transform(transform,
                                 lattice_to_mm(from->xy[first + i], from->z[first + i]));
        if (lattice_from_mm(p, n, LATTICE_PER_MM, q, NULL) != ST_OK)
            return ST_ERANGE;
        for (uint32_t i = 0; i < n; i++) {
            m->xy[first + i] = (struct ivec2){q[i].x, q[i].y};
            m->z[first + i] = q[i].z;
        }
    }
    return ST_OK;
}

/* m's points are triangulated anew. */
static enum status rebuild(struct mesh *m, struct scratch *pts, struct scratch *s)
{
    const size_t n = m->nv;
    struct ivec3 *p = scratch_need(pts, 2 * n * sizeof *p);

    if (p == NULL)
        return ST_ENOMEM;
    for (size_t v = 0; v < n; v++)
        p[v] = (struct ivec3){m->xy[v].x, m->xy[v].y, m->z[v]};
    return delaunay_numbered(p, n, s, m);
}

enum status surface_move(const struct surface *from, const double transform[16],
                         struct scratch *pts, struct scratch *s, struct surface *out)
{
    const struct mesh *m = &from->mesh;
    enum status st = mesh_copy(&out->mesh, m, 0);

    if (st == ST_OK)
        st = surface_place(m, transform, &out->mesh);
    if (st == ST_OK && (st = repair_mesh(&out->mesh, s)) == ST_ELIMIT)
        st = rebuild(&out->mesh, pts, s);
    if (st == ST_OK)
        st = reserve(out, m->nv);
    if (st != ST_OK) {
        out->mesh.nv = out->mesh.nt = 0;
        return st;
    }
    memcpy(out->mesh.parent, m->parent, m->nv * sizeof *m->parent);
    memcpy(out->spacing, from->spacing, m->nv * sizeof *from->spacing);
    out->measured = holes_mark(&out->mesh, out->spacing, out->bridge);
    out->spikes = from->spikes;
    return ST_OK;
}

void surface_free(struct surface *s)
{
    if (s == NULL)
        return;
    mesh_free(&s->mesh);
    mem_free(s->block);
    memset(s, 0, sizeof *s);
}
