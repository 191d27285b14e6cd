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

#define LANES 4
typedef float lanes __attribute__((vector_size(4 * LANES)));
typedef int32_t masks __attribute__((vector_size(4 * LANES)));

/* Is any of them true? */
static inline bool any(masks m)
{
    uint64_t half[2];

    memcpy(half, &m, sizeof half);
    return (half[0] | half[1]) != 0;
}

/* Squared distances. */
static inline lanes apart(masks ax, masks ay, masks bx, masks by)
{
    const lanes x = __builtin_convertvector(bx - ax, lanes);
    const lanes y = __builtin_convertvector(by - ay, lanes);

    return x * x + y * y;
}

/* May one of the LANES triangles from t on be wide, or is one a ghost?  In single precision,
 * and a little too readily: in nearly all of them no side is long for its spacing. */
static inline bool suspect(const struct mesh *m, const float *spacing, uint32_t t)
{
    const uint32_t *const v = &m->org[3 * t];
    const struct ivec2 *const xy = m->xy;
    masks corner[3], x[3], y[3];
    lanes sum = {0}, limit;

    memcpy(corner, v, sizeof corner);
    if (any((corner[0] == (int32_t)m->nv) | (corner[1] == (int32_t)m->nv) |
            (corner[2] == (int32_t)m->nv)))
        return true;
    for (uint32_t k = 0; k < 3; k++) {
        const struct ivec2 a = xy[v[k]], b = xy[v[k + 3]], c = xy[v[k + 6]];
        const struct ivec2 d = xy[v[k + 9]];

        x[k] = (masks){a.x, b.x, c.x, d.x};
        y[k] = (masks){a.y, b.y, c.y, d.y};
        sum += (lanes){spacing[v[k]], spacing[v[k + 3]], spacing[v[k + 6]],
                       spacing[v[k + 9]]};
    }
    limit = sum * sum * (float)(0.999 * HOLES_SIDE * HOLES_SIDE / 9);
    return any((apart(x[0], y[0], x[1], y[1]) > limit) |
               (apart(x[1], y[1], x[2], y[2]) > limit) |
               (apart(x[2], y[2], x[0], y[0]) > limit));
}

/* Mark the triangle t.  Returns what it adds to twice the measured area: a ghost the fan from
 * the origin to its side of the hull, a triangle that bridges less its own. */
static int64_t mark(const struct mesh *m, const float *spacing, uint32_t t,
                    uint8_t *bridge)
{
    const uint32_t *const v = &m->org[3 * t], nv = m->nv;
    double sum, twice;

    bridge[t] = 1;
    if (mesh_is_ghost(m, t)) {
        const uint32_t k = v[0] == nv ? 1 : v[1] == nv ? 2 : 0;
        const struct ivec2 a = m->xy[v[k]], b = m->xy[v[(k + 1) % 3]];

        return (int64_t)b.x * a.y - (int64_t)b.y * a.x;
    }
    sum = (double)spacing[v[0]] + (double)spacing[v[1]] + (double)spacing[v[2]];
    bridge[t] = holes_wide(m->xy[v[0]], m->xy[v[1]], m->xy[v[2]], sum, &twice);
    return bridge[t] ? -(int64_t)twice : 0;
}

double holes_mark(const struct mesh *m, const float *spacing, uint8_t *bridge)
{
    const uint32_t nt = m->nt;
    int64_t measured = 0; /* twice the area: that of the hull, less what bridges */

    memset(bridge, 0, nt);
    for (uint32_t t = 0; t < nt; t += LANES) {
        if (t + LANES <= nt && !suspect(m, spacing, t))
            continue;
        for (uint32_t k = t; k < t + LANES && k < nt; k++)
            measured += mark(m, spacing, k, bridge);
    }
    return 0.5 * (double)measured;
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
