#include "surface.h"

#include <string.h>

#include "delaunay.h"
#include "holes.h"
#include "lattice.h"
#include "mem.h"
#include "mst.h"
#include "spikes.h"

/* s's arrays in block for n points; returns the bytes needed. */
static size_t layout(struct surface *s, size_t n, unsigned char *block)
{
    size_t at = 0;

    s->raw = mem_take(block, &at, n, sizeof *s->raw);
    s->spacing = mem_take(block, &at, n, sizeof *s->spacing);
    s->bridge = mem_take(block, &at, 2 * n, sizeof *s->bridge);
    return at;
}

enum status surface_derive(struct surface *out, struct scratch *s)
{
    const struct mesh *m = &out->mesh;
    const size_t nv = m->nv;
    struct surface larger = {0};
    enum status st;

    if (out->block == NULL || out->cap < nv) {
        if ((larger.block = mem_array(layout(&larger, nv, NULL), 1)) == NULL)
            return ST_ENOMEM;
        mem_free(out->block);
        out->block = larger.block;
        out->cap = (uint32_t)nv;
    }
    (void)layout(out, nv, out->block);
    memcpy(out->raw, m->z, nv * sizeof *out->raw);
    if ((st = holes_spacing(m, s, out->spacing)) != ST_OK)
        return st;
    out->measured = holes_mark(m, out->spacing, out->bridge);
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
        st = spikes_flatten(m, s);
    if (st != ST_OK)
        m->nv = m->nt = 0;
    return st;
}

enum status surface_move(const struct surface *from, const double transform[16],
                         struct scratch *pts, struct scratch *s, struct surface *out)
{
    const struct mesh *m = &from->mesh;
    struct ivec3 *moved = scratch_need(pts, m->nv * sizeof *moved);

    out->mesh.nv = out->mesh.nt = 0;
    if (moved == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 p =
            vec_transform(transform, lattice_to_mm(m->xy[v], from->raw[v]));

        if (lattice_from_mm(&p, 1, LATTICE_PER_MM, &moved[v], NULL) != ST_OK)
            return ST_ERANGE;
    }
    return surface_prepare(moved, m->nv, true, s, out);
}

void surface_free(struct surface *s)
{
    if (s == NULL)
        return;
    mesh_free(&s->mesh);
    mem_free(s->block);
    memset(s, 0, sizeof *s);
}
