#include "measure.h"

#include <string.h>

#include "locate.h"
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

void measure_work_wipe(struct measure_work *w, size_t keep)
{
    struct measure_work empty = {
        .scratch = w->scratch, .points = w->points, .arrays = w->arrays};

    scratch_wipe(&empty.scratch, keep);
    scratch_wipe(&empty.points, keep);
    scratch_wipe(&empty.arrays, keep);
    surface_free(&w->moved);
    mesh_free(&w->general);
    *w = empty;
}

/* layout(w, na, nb, block): w's arrays for a template of na points and a probe of nb;
 * returns the bytes needed. */
static size_t measure_layout(struct measure_work *w, size_t na, size_t nb,
                             unsigned char *block)
{
    size_t at = 0;

    w->tmpl_in_moved = mem_take(block, &at, na, sizeof *w->tmpl_in_moved);
    w->moved_in_tmpl = mem_take(block, &at, nb, sizeof *w->moved_in_tmpl);
    w->tmpl_gap = mem_take(block, &at, na, sizeof *w->tmpl_gap);
    w->moved_gap = mem_take(block, &at, nb, sizeof *w->moved_gap);
    w->b_vertex = mem_take(block, &at, nb, sizeof *w->b_vertex);
    w->vertex = mem_take(block, &at, na + nb, sizeof *w->vertex);
    return at;
}

/* The gap between tmpl and probe moved by transform at the vertices of either: w->moved, the
 * locations and the gaps.  Where a moved point leaves the lattice, or the probe is seen edge-on,
 * the surfaces have nothing in common: w->moved.mesh.nv is 0.  So it is on failure. */
static enum status measure_gaps_at(const struct surface *tmpl,
                                   const struct surface *probe,
                                   const double transform[16], struct measure_work *w)
{
    const struct mesh *a = &tmpl->mesh, *b = &w->moved.mesh;
    unsigned char *block;
    enum status st;

    w->moved.mesh.nv = w->moved.mesh.nt = 0;
    block = scratch_need(&w->arrays, measure_layout(w, a->nv, probe->mesh.nv, NULL));
    if (block == NULL)
        return ST_ENOMEM;
    (void)measure_layout(w, a->nv, probe->mesh.nv, block);

    st = surface_move(probe, transform, &w->points, &w->scratch, &w->moved);
    if (st != ST_OK)
        return st == ST_ENOMEM ? st : ST_OK;
    if ((st = locate_mesh(a, b, w->moved_in_tmpl)) != ST_OK ||
        (st = locate_mesh(b, a, w->tmpl_in_moved)) != ST_OK) {
        w->moved.mesh.nv = w->moved.mesh.nt = 0;
        return st;
    }
    locate_heights(a, b, w->moved_in_tmpl, w->moved_gap);
    locate_heights(b, a, w->tmpl_in_moved, w->tmpl_gap);
    disparity_gaps(tmpl, &w->moved, w->tmpl_in_moved, false, w->tmpl_gap);
    disparity_gaps(&w->moved, tmpl, w->moved_in_tmpl, true, w->moved_gap);
    return ST_OK;
}

enum status measure_at(const struct surface *tmpl, const struct surface *probe,
                       const double transform[16], const struct disparity_weight *u,
                       struct measure_work *w, struct disparity *out)
{
    enum status st;

    memset(out, 0, sizeof *out);
    w->general.nv = w->general.nt = 0;
    st = measure_gaps_at(tmpl, probe, transform, w);
    if (st != ST_OK || w->moved.mesh.nv == 0)
        return st;
    st = merge_build(&tmpl->mesh, &w->moved.mesh, w->moved_in_tmpl, &w->scratch,
                     &w->general, w->b_vertex);
    if (st != ST_OK)
        return st == ST_ENOMEM ? st : ST_OK;
    disparity_measure(&w->general, w->b_vertex,
                      &(struct disparity_side){tmpl, w->tmpl_gap},
                      &(struct disparity_side){&w->moved, w->moved_gap}, u,
                      LATTICE_PER_MM, w->vertex, out);
    return ST_OK;
}
