#include "measure.h"

#include <string.h>

#include "delaunay.h"
#include "holes.h"
#include "lattice.h"
#include "merge.h"
#include "mst.h"
#include "quality.h"
#include "surface.h"

void measure_work_free(struct measure_work *w)
{
    if (w == NULL)
        return;
    scratch_free(&w->scratch);
    scratch_free(&w->arrays);
    mesh_free(&w->moved);
    mesh_free(&w->general);
    memset(w, 0, sizeof *w);
}

/* take(block, at, n, size): the next n objects of the block, each array on its own cache
 * line; with block NULL only the size is counted. */
static void *take(unsigned char *block, size_t *at, size_t n, size_t size)
{
    unsigned char *p = block == NULL ? NULL : block + *at;

    *at += mem_round(n * size);
    return p;
}

/* layout(w, na, nb, block): w's arrays for a template of na points and a probe of nb;
 * returns the bytes needed. */
static size_t layout(struct measure_work *w, size_t na, size_t nb, unsigned char *block)
{
    size_t at = 0;

    w->pts = take(block, &at, nb, sizeof *w->pts);
    w->tmpl_in_moved = take(block, &at, na, sizeof *w->tmpl_in_moved);
    w->moved_in_tmpl = take(block, &at, nb, sizeof *w->moved_in_tmpl);
    w->tmpl_other = take(block, &at, na, sizeof *w->tmpl_other);
    w->moved_other = take(block, &at, nb, sizeof *w->moved_other);
    w->spacing = take(block, &at, nb, sizeof *w->spacing);
    w->bridge = take(block, &at, 2 * nb, sizeof *w->bridge);
    w->b_vertex = take(block, &at, nb, sizeof *w->b_vertex);
    w->vertex = take(block, &at, na + nb, sizeof *w->vertex);
    w->ground = take(block, &at, na + nb, sizeof *w->ground);
    return at;
}

/* move(m, raw, t, out): the vertices of m at their raw heights, moved by t and rounded; ST_ERANGE when one falls off
 * the lattice. */
static enum status move(const struct mesh *m, const int32_t *raw, const double t[16],
                        struct ivec3 *out)
{
    for (uint32_t v = 0; v < m->nv; v++) {
        const double x = m->xy[v].x / LATTICE_PER_MM, y = m->xy[v].y / LATTICE_PER_MM;
        const double z = raw[v] / LATTICE_PER_MM;
        const struct dvec3 q = {t[0] * x + t[1] * y + t[2] * z + t[3],
                                t[4] * x + t[5] * y + t[6] * z + t[7],
                                t[8] * x + t[9] * y + t[10] * z + t[11]};

        if (lattice_from_mm(&q, 1, LATTICE_PER_MM, &out[v], NULL) != ST_OK)
            return ST_ERANGE;
    }
    return ST_OK;
}

/* prepare(w, n, measured): from w->pts[0..n-1] the moved mesh, its tree and its holes. */
static enum status prepare(struct measure_work *w, uint32_t n, double *measured)
{
    enum status st = delaunay_build(w->pts, n, &w->scratch, &w->moved);

    if (st == ST_OK)
        st = mst_build(&w->moved, &w->scratch);
    if (st == ST_OK)
        st = quality_spikes(&w->moved, &w->scratch);
    if (st == ST_OK)
        st = holes_spacing(&w->moved, &w->scratch, w->spacing);
    if (st == ST_OK)
        *measured = holes_mark(&w->moved, w->spacing, w->bridge);
    return st;
}

enum status measure_at(const struct measure_surface *tmpl,
                       const struct measure_surface *probe, const double transform[16],
                       const struct disparity_weight *u, struct measure_work *w,
                       struct disparity *out)
{
    const struct mesh *a = tmpl->mesh, *b = &w->moved;
    struct disparity_side sa = {a,    tmpl->spacing, tmpl->bridge, tmpl->measured,
                                NULL, NULL};
    struct disparity_side sb = {b, NULL, NULL, 0.0, NULL, NULL};
    unsigned char *block;
    enum status st;

    memset(out, 0, sizeof *out);
    w->general.nv = w->general.nt = 0;
    block = scratch_need(&w->arrays, layout(w, a->nv, probe->mesh->nv, NULL));
    if (block == NULL)
        return ST_ENOMEM;
    (void)layout(w, a->nv, probe->mesh->nv, block);

    if ((st = move(probe->mesh, probe->raw, transform, w->pts)) != ST_OK ||
        (st = prepare(w, probe->mesh->nv, &sb.measured)) != ST_OK)
        return st == ST_ENOMEM ? st : ST_OK;
    locate_mesh(a, b, w->moved_in_tmpl);
    locate_mesh(b, a, w->tmpl_in_moved);
    surface_interpolate(a, b, w->moved_in_tmpl, w->moved_other);
    surface_interpolate(b, a, w->tmpl_in_moved, w->tmpl_other);
    st = merge_build(a, b, w->moved_in_tmpl, &w->scratch, &w->general, w->b_vertex);
    if (st != ST_OK)
        return st == ST_ENOMEM ? st : ST_OK;
    sa.loc = w->tmpl_in_moved;
    sa.other = w->tmpl_other;
    sb.spacing = w->spacing;
    sb.bridge = w->bridge;
    sb.loc = w->moved_in_tmpl;
    sb.other = w->moved_other;
    for (uint32_t v = 0; v < a->nv; v++)
        w->ground[v] = a->z[v];
    for (uint32_t v = 0; v < b->nv; v++)
        if (w->b_vertex[v] >= a->nv)
            w->ground[w->b_vertex[v]] = w->moved_other[v];
    w->measured = sb.measured;
    disparity_measure(&w->general, w->b_vertex, &sa, &sb, u, LATTICE_PER_MM, w->vertex,
                      out);
    return ST_OK;
}
