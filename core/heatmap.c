#include "heatmap.h"

#include <math.h>
#include <stdint.h>

#include "holes.h"
#include "interpolate.h"
#include "lattice.h"
#include "locate.h"
#include "surface.h"

/* A grid of SIDE x SIDE over the template's extent, with a half-edge of a real triangle for
 * each place: every walk starts near its point, in any order of the points, and a point's gap
 * depends on no other point. */
#define SIDE 64

struct places {
    double x, y, per_x, per_y; /* places a lattice unit */
    uint32_t he[SIDE][SIDE];
};

static uint32_t place(double at, double low, double per)
{
    const double k = (at - low) * per;

    return k <= 0 ? 0 : k < SIDE ? (uint32_t)k : SIDE - 1;
}

static uint32_t *place_of(struct places *s, struct ivec2 q)
{
    return &s->he[place(q.y, s->y, s->per_y)][place(q.x, s->x, s->per_x)];
}

static void prepare(const struct mesh *m, struct places *s)
{
    struct ivec2 lo = m->xy[0], hi = m->xy[0];
    uint32_t last = 0;

    for (uint32_t v = 1; v < m->nv; v++) {
        const struct ivec2 q = m->xy[v];

        lo.x = q.x < lo.x ? q.x : lo.x;
        lo.y = q.y < lo.y ? q.y : lo.y;
        hi.x = q.x > hi.x ? q.x : hi.x;
        hi.y = q.y > hi.y ? q.y : hi.y;
    }
    s->x = lo.x;
    s->y = lo.y;
    s->per_x = SIDE / ((double)hi.x - lo.x);
    s->per_y = SIDE / ((double)hi.y - lo.y);
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        s->he[i / SIDE][i % SIDE] = UINT32_MAX;
    for (uint32_t v = m->nv; v-- > 0;) {
        last = m->out[v];
        while (mesh_is_ghost(m, last / 3))
            last = mesh_turn(m, last);
        *place_of(s, m->xy[v]) = last;
    }
    for (uint32_t y = 0; y < SIDE; y++) /* empty places: as the one before, or below */
        for (uint32_t x = 0; x < SIDE; x++) {
            if (s->he[y][x] == UINT32_MAX)
                s->he[y][x] = x > 0 ? s->he[y][x - 1] : y > 0 ? s->he[y - 1][0] : last;
        }
}

void heatmap_gaps(const struct surface *tmpl, const struct dvec3 *pts, size_t n,
                  const double transform[16], double *gap_mm)
{
    const struct mesh *m = &tmpl->mesh;
    struct places places;

    prepare(m, &places);
    for (size_t i = 0; i < n; i++) {
        const struct dvec3 moved = vec_transform(transform, pts[i]);
        struct location at;
        struct ivec3 p;
        struct ivec2 q;

        gap_mm[i] = NAN;
        if (lattice_from_mm(&moved, 1, LATTICE_PER_MM, &p, NULL) != ST_OK)
            continue;
        q = (struct ivec2){p.x, p.y};
        at.he = *place_of(&places, q);
        at = locate_point(m, at.he, m->xy[m->org[at.he]], q, NULL);
        if (at.where != LOCATE_OUTSIDE && holes_measured(m, tmpl->bridge, at))
            gap_mm[i] = (p.z - interpolate_height(m, at, q)) / LATTICE_PER_MM;
    }
}
