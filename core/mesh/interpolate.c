#include "interpolate.h"

#include <math.h>

#include "locate.h"
#include "mesh.h"
#include "predicates.h"

/* Heights relative to the corner org[he], so that one formula serves the inside (three
 * weights), an edge (the third weight is an exact 0) and a vertex (two are 0).  Each weight
 * is twice the area opposite a corner, an integer below 2^53: exact. */
static inline double height(const struct mesh *m, struct location loc, struct ivec2 q)
{
    uint32_t a, b, c;
    int64_t wb, wc, area;

    if (loc.where == LOCATE_OUTSIDE)
        return NAN;
    a = m->org[loc.he];
    b = mesh_dest(m, loc.he);
    c = m->org[mesh_prev(loc.he)];
    wb = orient2d(m->xy[c], m->xy[a], q);
    wc = orient2d(m->xy[a], m->xy[b], q);
    area = orient2d(m->xy[a], m->xy[b], m->xy[c]);
    return m->z[a] + ((double)wb * ((double)m->z[b] - m->z[a]) +
                      (double)wc * ((double)m->z[c] - m->z[a])) /
                         (double)area;
}

double interpolate_height(const struct mesh *m, struct location loc, struct ivec2 q)
{
    return height(m, loc, q);
}

void interpolate_mesh(const struct mesh *m, const struct mesh *pts,
                      const struct location *loc, double *out)
{
    for (uint32_t v = 0; v < pts->nv; v++)
        out[v] = height(m, loc[v], pts->xy[v]);
}
