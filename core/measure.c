#include "measure.h"

#include <string.h>

#include "interpolate.h"
#include "lattice.h"
#include "merge.h"

void measure_work_free(struct measure_work *w)
{
    if (w == NULL)
        return;
    scratch_free(&w->scratch);
    scratch_free(&w->points);
    scratch_free(&w->arrays);
    surface_free(&w->moved);
    mesh_free(&w->general);
    memset(w, 0, sizeof *w);
}

/* layout(w, na, nb, block): w's arrays for a template of na points and a probe of nb;
 * returns the bytes needed. */
static size_t layout(struct measure_work *w, size_t na, size_t nb, unsigned char *block)
{
    size_t at = 0;

    w->tmpl_in_moved = mem_take(block, &at, na, sizeof *w->tmpl_in_moved);
    w->moved_in_tmpl = mem_take(block, &at, nb, sizeof *w->moved_in_tmpl);
    w->tmpl_other = mem_take(block, &at, na, sizeof *w->tmpl_other);
    w->moved_other = mem_take(block, &at, nb, sizeof *w->moved_other);
    w->b_vertex = mem_take(block, &at, nb, sizeof *w->b_vertex);
    w->vertex = mem_take(block, &at, na + nb, sizeof *w->vertex);
    w->ground = mem_take(block, &at, na + nb, sizeof *w->ground);
    return at;
}

enum status measure_at(const struct surface *tmpl, const struct surface *probe,
                       const double transform[16], const struct disparity_weight *u,
                       struct measure_work *w, struct disparity *out)
{
    const struct mesh *a = &tmpl->mesh, *b = &w->moved.mesh;
    unsigned char *block;
    enum status st;

    memset(out, 0, sizeof *out);
    w->general.nv = w->general.nt = 0;
    block = scratch_need(&w->arrays, layout(w, a->nv, probe->mesh.nv, NULL));
    if (block == NULL)
        return ST_ENOMEM;
    (void)layout(w, a->nv, probe->mesh.nv, block);

    st = surface_move(probe, transform, &w->points, &w->scratch, &w->moved);
    if (st != ST_OK)
        return st == ST_ENOMEM ? st : ST_OK;
    locate_mesh(a, b, w->moved_in_tmpl);
    locate_mesh(b, a, w->tmpl_in_moved);
    interpolate_mesh(a, b, w->moved_in_tmpl, w->moved_other);
    interpolate_mesh(b, a, w->tmpl_in_moved, w->tmpl_other);
    st = merge_build(a, b, w->moved_in_tmpl, &w->scratch, &w->general, w->b_vertex);
    if (st != ST_OK)
        return st == ST_ENOMEM ? st : ST_OK;
    for (uint32_t v = 0; v < a->nv; v++)
        w->ground[v] = a->z[v];
    for (uint32_t v = 0; v < b->nv; v++)
        if (w->b_vertex[v] >= a->nv)
            w->ground[w->b_vertex[v]] = w->moved_other[v];
    disparity_measure(
        &w->general, w->b_vertex,
        &(struct disparity_side){tmpl, w->tmpl_in_moved, w->tmpl_other},
        &(struct disparity_side){&w->moved, w->moved_in_tmpl, w->moved_other}, u,
        LATTICE_PER_MM, w->vertex, out);
    return ST_OK;
}
