#include "surface.h"

#include <string.h>

#include "delaunay.h"
#include "holes.h"
#include "lattice.h"
#include "mem.h"
#include "mst.h"
#include "numbered.h"
#include "spikes.h"

/* s's arrays in block for n points; returns the bytes needed. */
static size_t layout(struct surface *s, size_t n, unsigned char *block)
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
        if ((larger.block = mem_array(layout(&larger, n, NULL), 1)) == NULL)
            return ST_ENOMEM;
        mem_free(s->block);
        s->block = larger.block;
        s->cap = n;
    }
    (void)layout(s, n, s->block);
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

enum status surface_move(const struct surface *from, const double transform[16],
                         struct scratch *pts, struct scratch *s, struct surface *out)
{
    const struct mesh *m = &from->mesh;
    struct ivec3 *moved = scratch_need(pts, 2 * (size_t)m->nv * sizeof *moved);
    enum status st = moved == NULL ? ST_ENOMEM : ST_OK;

    for (uint32_t v = 0; st == ST_OK && v < m->nv; v++) {
        const struct dvec3 p = vec_transform(transform, lattice_to_mm(m->xy[v], m->z[v]));

        st = lattice_from_mm(&p, 1, LATTICE_PER_MM, &moved[v], NULL);
    }
    if (st == ST_OK)
        st = numbered_build(moved, m->nv, s, &out->mesh);
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
