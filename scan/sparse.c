#include "sparse.h"

#include <math.h>

#include "grid.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "surface.h"

#define MOST 16 /* parts of a side: wider triangles bridge */

static struct dvec3 vertex(const struct mesh *m, uint32_t v)
{
    return lattice_to_mm(m->xy[v], m->z[v]);
}

/* Parts into which the sides of triangle t are cut, none longer than a cell; 0: it bridges. */
static uint32_t parts_of(const struct surface *f, uint32_t t)
{
    const struct mesh *m = &f->mesh;
    double most = 0;

    if (mesh_is_ghost(m, t) || f->bridge[t])
        return 0;
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
        const struct dvec3 d = vec_sub(vertex(m, m->org[h]), vertex(m, mesh_dest(m, h)));

        most = fmax(most, d.x * d.x + d.y * d.y);
    }
    most = ceil(sqrt(most) * (1 / GRID_MM));
    return most < MOST ? (uint32_t)most : MOST;
}

/* One in the middle of each of the parts * parts small triangles, to p[n]...; returns n. */
static size_t fill(const struct mesh *m, uint32_t t, uint32_t parts, struct dvec3 *p,
                   size_t n)
{
    const struct dvec3 o = vertex(m, m->org[3 * t]);
    const struct dvec3 a = vec_sub(vertex(m, m->org[3 * t + 1]), o);
    const struct dvec3 b = vec_sub(vertex(m, m->org[3 * t + 2]), o);
    const double third = 1.0 / (3 * parts);

    for (uint32_t i = 0; i < parts; i++)
        for (uint32_t j = 0; i + j < parts; j++) {
            p[n++] =
                vec_along(vec_along(o, (3 * i + 1) * third, a), (3 * j + 1) * third, b);
            if (i + j + 1 < parts)
                p[n++] = vec_along(vec_along(o, (3 * i + 2) * third, a),
                                   (3 * j + 2) * third, b);
        }
    return n;
}

enum status sparse_points(const struct surface *f, struct dvec3 **out, size_t *n)
{
    const struct mesh *m = &f->mesh;
    size_t all = m->nv;

    for (uint32_t t = 0; t < m->nt; t++) {
        const size_t parts = parts_of(f, t);

        all += parts * parts;
    }
    *n = 0;
    if ((*out = mem_array(all, sizeof **out)) == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v++)
        (*out)[(*n)++] = vertex(m, v);
    for (uint32_t t = 0; t < m->nt; t++) {
        const uint32_t parts = parts_of(f, t);

        if (parts > 0)
            *n = fill(m, t, parts, *out, *n);
    }
    return ST_OK;
}
