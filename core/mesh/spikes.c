#include "spikes.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "plane.h"
#include "select.h"

/* A spike rises above a neighbour by more than this (mm), and more steeply than 45 degrees,
 * so that neither noise nor the side of a nose is one.  By hand. */
#define SPIKES_STEP_MM 1

/* It does so above (or below) this many quarters of its neighbours: on an edge of the
 * surface only about half of them lie below.  By hand. */
#define SPIKES_QUARTERS 3

#define STEP (SPIKES_STEP_MM * (int64_t)LATTICE_PER_MM)

/* Does a lie far above b (1), far below (-1), or neither (0)?  In squares, on whole
 * numbers. */
static int spikes_step(const struct mesh *m, uint32_t a, uint32_t b)
{
    const int64_t dx = m->xy[b].x - m->xy[a].x, dy = m->xy[b].y - m->xy[a].y;
    const int64_t rise = (int64_t)m->z[a] - m->z[b];
    const int64_t over = (rise < 0 ? -rise : rise) - STEP;

    if ((over <= 0) | (over * over <= dx * dx + dy * dy))
        return 0;
    return rise > 0 ? 1 : -1;
}

static bool is_spike(const struct mesh *m, uint32_t v)
{
    const uint32_t first = m->out[v];
    uint32_t h = first, neighbours = 0, above = 0, below = 0;

    do {
        const uint32_t w = mesh_dest(m, h);

        if (w != m->nv) {
            const int side = spikes_step(m, v, w);

            above += side > 0;
            below += side < 0;
            neighbours++;
        }
        h = mesh_turn(m, h);
    } while (h != first);
    return 4 * above >= SPIKES_QUARTERS * neighbours ||
           4 * below >= SPIKES_QUARTERS * neighbours;
}

/* The height at v of the plane through its neighbours that are no spikes, as far as it lies
 * between their heights; else their median.  v's own when all are spikes.  (Where points are
 * few a face bends between them: the median is off by as much as the plane leans.) */
static int32_t height_round(const struct mesh *m, uint32_t v, const uint8_t *spike,
                            double *z)
{
    const uint32_t first = m->out[v];
    double low = INFINITY, high = -INFINITY, a, b, c;
    struct plane plane = {0};
    uint32_t h = first;
    size_t n = 0;

    do {
        const uint32_t w = mesh_dest(m, h);

        if (w != m->nv && !spike[w]) {
            z[n] = m->z[w];
            low = z[n] < low ? z[n] : low;
            high = z[n] > high ? z[n] : high;
            plane_add(&plane, (double)m->xy[w].x - m->xy[v].x,
                      (double)m->xy[w].y - m->xy[v].y, z[n++]);
        }
        h = mesh_turn(m, h);
    } while (h != first);
    if (n == 0)
        return m->z[v];
    if (plane_solve(&plane, &a, &b, &c) && c >= low && c <= high)
        return (int32_t)c;
    return (int32_t)select_kth(z, n, n / 2);
}

enum status spikes_flatten(struct mesh *m, struct scratch *s, uint32_t *count)
{
    const size_t flags = mem_round(m->nv);
    uint8_t *spike = scratch_need(s, flags + m->nv * sizeof(double));

    if (spike == NULL)
        return ST_ENOMEM;
    memset(spike, 0, m->nv);
    for (uint32_t v = 1; v < m->nv; v++) {
        const uint32_t up = m->parent[v];

        if (__builtin_expect(spikes_step(m, v, up) != 0, 0)) {
            spike[v] = is_spike(m, v);
            spike[up] = is_spike(m, up);
        }
    }
    *count = 0;
    for (uint32_t v = 0; v < m->nv; v++) {
        if (spike[v]) {
            const int32_t z = m->z[v];

            m->z[v] = height_round(m, v, spike, (double *)(void *)(spike + flags));
            *count += m->z[v] != z;
        }
    }
    return ST_OK;
}
