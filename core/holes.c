#include "holes.h"

#include <math.h>
#include <string.h>

#include "locate.h"
#include "mem.h"
#include "mesh.h"

/* Lengths of tree edges, and how many. */
struct sum {
    double length, count;
};

enum status holes_spacing(const struct mesh *m, struct scratch *s, float *spacing)
{
    const uint32_t nv = m->nv;
    struct sum *at = scratch_need(s, 2 * nv * sizeof *at), *near;
    double all = 0, most;

    if (at == NULL)
        return ST_ENOMEM;
    near = at + nv;
    memset(at, 0, nv * sizeof *at);
    for (uint32_t v = 1; v < nv; v++) {
        const uint32_t p = m->parent[v];
        const double dx = m->xy[v].x - m->xy[p].x, dy = m->xy[v].y - m->xy[p].y;
        const double length = sqrt(dx * dx + dy * dy);

        all += length;
        at[v].length += length;
        at[v].count += 1;
        at[p].length += length;
        at[p].count += 1;
    }
    for (int step = 0; step < 2; step++) { /* every vertex adds its neighbours' sums */
        struct sum *const t = at;

        memcpy(near, at, nv * sizeof *at);
        for (uint32_t v = 1; v < nv; v++) {
            const uint32_t p = m->parent[v];

            near[v].length += at[p].length;
            near[v].count += at[p].count;
            near[p].length += at[v].length;
            near[p].count += at[v].count;
        }
        at = near;
        near = t;
    }
    most = HOLES_MOST * all / (nv - 1);
    for (uint32_t v = 0; v < nv; v++) {
        const double mean = at[v].length / at[v].count;

        spacing[v] = (float)(mean < most ? mean : most);
    }
    return ST_OK;
}

double holes_mark(const struct mesh *m, const float *spacing, uint8_t *bridge)
{
    const uint32_t nv = m->nv, nt = m->nt;
    const uint32_t *const org = m->org;
    const struct ivec2 *const xy = m->xy;
    double measured = 0; /* twice the area: a whole number below 2^52, like the hull's */

    for (uint32_t t = 0; t < nt; t++) {
        const uint32_t a = org[3 * t], b = org[3 * t + 1], c = org[3 * t + 2];
        double twice, sum;
        bool wide;

        if (__builtin_expect((a == nv) | (b == nv) | (c == nv), 0)) {
            bridge[t] = 1;
            continue;
        }
        sum = (double)spacing[a] + (double)spacing[b] + (double)spacing[c];
        wide = holes_wide(xy[a], xy[b], xy[c], sum, &twice);
        bridge[t] = wide;
        measured += wide ? 0 : twice;
    }
    return 0.5 * measured;
}

bool holes_measured(const struct mesh *m, const uint8_t *bridge, struct location loc)
{
    if (!bridge[loc.he / 3])
        return true;
    if (loc.where == LOCATE_EDGE)
        return !bridge[m->twin[loc.he] / 3];
    if (loc.where == LOCATE_VERTEX)
        for (uint32_t h = mesh_turn(m, loc.he); h != loc.he; h = mesh_turn(m, h))
            if (!bridge[h / 3])
                return true;
    return false;
}
