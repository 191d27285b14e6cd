#include "quality.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "frame.h"
#include "lattice.h"
#include "mem.h"
#include "mesh.h"
#include "plane.h"
#include "predicates.h"
#include "select.h"
#include "series.h"
#include "surface.h"

/* One in this many points is left out at either end of each axis for the largest extent: a few
 * stray points do not matter. */
#define QUALITY_STRAY_IN 100

/* Root mean square distance from the best plane, mm: below it there is no relief.  By
 * hand. */
#define QUALITY_RELIEF_MIN_MM 3

/* White noise, mm: the limit, at which the score is 0 too.  Of scans of a good scanner 99 in
 * 100 have less than 0.51. */
#define QUALITY_NOISE_MAX_MM 3.0

/* Steps of depth: up to NONE nothing counts, from ALL on all of it. */
#define QUALITY_STEP_NONE_MM 1.0
#define QUALITY_STEP_ALL_MM  1.4

/* Noise is estimated from every n-th point: enough for a median, a quarter of the time. */
#define QUALITY_NOISE_STRIDE 4

/* The median of |x| of a normal distribution is its deviation over this. */
#define QUALITY_MEDIAN 1.4826

/* Measured area over the outline's area below which a scan says nothing.  By hand. */
#define QUALITY_COVER_MIN 0.1

/* Share of points that stand out as spikes, beyond which noise hides in them: white noise of
 * 58 mm had more than half laid flat and passed as 1.9 mm.  Simulated scans have 2 % at
 * most; a face seen from 28 degrees aside folds over itself in a tenth of its points. */
#define QUALITY_SPIKES_MAX 0.25

enum status quality_extent(const struct ivec3 *pts, size_t n, struct scratch *s)
{
    const size_t stray = n / QUALITY_STRAY_IN;
    struct ivec3 lo = pts[0], hi = pts[0];
    double side;
    double *v;

    for (size_t i = 1; i < n; i++) {
        const struct ivec3 p = pts[i];

        lo.x = p.x < lo.x ? p.x : lo.x;
        lo.y = p.y < lo.y ? p.y : lo.y;
        lo.z = p.z < lo.z ? p.z : lo.z;
        hi.x = p.x > hi.x ? p.x : hi.x;
        hi.y = p.y > hi.y ? p.y : hi.y;
        hi.z = p.z > hi.z ? p.z : hi.z;
    }
    side = fmax(fmax((double)hi.x - lo.x, (double)hi.y - lo.y), (double)hi.z - lo.z);
    if (side < SURFACE_EXTENT_MIN_MM * LATTICE_PER_MM)
        return ST_EUNITS;
    if (side <= SURFACE_EXTENT_MAX_MM * LATTICE_PER_MM)
        return ST_OK;
    if ((v = scratch_need(s, n * sizeof *v)) == NULL)
        return ST_ENOMEM;
    for (int axis = 0; axis < 3; axis++) {
        for (size_t i = 0; i < n; i++)
            v[i] = axis == 0 ? pts[i].x : axis == 1 ? pts[i].y : pts[i].z;
        if (select_kth(v, n, n - 1 - stray) - select_kth(v, n, stray) >
            SURFACE_EXTENT_MAX_MM * LATTICE_PER_MM)
            return ST_EUNITS;
    }
    return ST_OK;
}

/* Root mean square distance in height from the best plane; 0 when there is none. */
static double relief(const struct mesh *m)
{
    struct plane f = {0};
    double a, b, c, sum = 0;

    for (uint32_t v = 0; v < m->nv; v++)
        plane_add(&f, (double)m->xy[v].x - m->xy[0].x, (double)m->xy[v].y - m->xy[0].y,
                  (double)m->z[v] - m->z[0]);
    if (!plane_solve(&f, &a, &b, &c))
        return 0;
    for (uint32_t v = 0; v < m->nv; v++) {
        const double r = (double)m->z[v] - m->z[0] - c -
                         a * ((double)m->xy[v].x - m->xy[0].x) -
                         b * ((double)m->xy[v].y - m->xy[0].y);

        sum += r * r;
    }
    return sqrt(sum / m->nv / (1 + a * a + b * b));
}

/* The distance along the normal of vertex v from the plane through its neighbours, scaled to
 * the noise's deviation; -1: there is no such plane. */
static double ring_residual(const struct mesh *m, uint32_t v)
{
    const uint32_t first = m->out[v];
    struct plane f = {0};
    uint32_t h = first;
    double a, b, c;

    do {
        const uint32_t w = mesh_dest(m, h);

        if (w == m->nv)
            return -1;
        plane_add(&f, (double)m->xy[w].x - m->xy[v].x, (double)m->xy[w].y - m->xy[v].y,
                  (double)m->z[w] - m->z[v]);
        h = mesh_turn(m, h);
    } while (h != first);
    if (f.n < 4 || !plane_solve(&f, &a, &b, &c))
        return -1;
    /* The plane's own error at v adds about 1 / n of the noise's variance. */
    return fabs(c) / sqrt((1 + a * a + b * b) * (1 + 1 / f.n));
}

enum status quality_noise(const struct mesh *m, uint32_t stride, struct scratch *s,
                          double *out)
{
    double *r = scratch_need(s, (m->nv / stride + 1) * sizeof *r);
    size_t n = 0;

    if (r == NULL)
        return ST_ENOMEM;
    for (uint32_t v = 0; v < m->nv; v += stride) {
        const double d = ring_residual(m, v);

        if (d >= 0)
            r[n++] = d;
    }
    *out = n == 0 ? 0 : QUALITY_MEDIAN * select_kth(r, n, n / 2) / LATTICE_PER_MM;
    return ST_OK;
}

static double hull_area(const struct mesh *m)
{
    const uint32_t first = m->out[m->nv];
    const struct ivec2 o = m->xy[mesh_dest(m, first)];
    uint32_t h = first;
    double twice = 0;

    do { /* a fan from one corner of the convex hull */
        const struct ivec2 a = m->xy[mesh_dest(m, h)];

        h = mesh_turn(m, h);
        twice += fabs((double)orient2d(o, a, m->xy[mesh_dest(m, h)]));
    } while (h != first);
    return twice / 2;
}

double quality_step(double step_mm)
{
    const double way =
        (step_mm - QUALITY_STEP_NONE_MM) / (QUALITY_STEP_ALL_MM - QUALITY_STEP_NONE_MM);

    return step_mm * fmax(0, fmin(way, 1));
}

enum status quality_rate(const struct surface *f, double step_mm, struct scratch *s,
                         struct surface_quality *q)
{
    const struct mesh *m = &f->mesh;
    const double area = hull_area(m);
    double rough, dense, smooth, noise;

    if (quality_noise(m, QUALITY_NOISE_STRIDE, s, &noise) != ST_OK)
        return ST_ENOMEM;
    rough = relief(m);
    q->coverage = fmin(1, f->measured / area);
    q->density_mm = sqrt(f->measured / m->nv) / LATTICE_PER_MM;
    q->noise_mm = fmax(noise, quality_step(step_mm) / 2);
    dense = fmin(1, SURFACE_SPARSE_MM / q->density_mm);
    smooth = fmax(0, 1 - q->noise_mm / QUALITY_NOISE_MAX_MM);
    q->score = fmin(q->coverage, fmin(dense, smooth));
    if (rough < QUALITY_RELIEF_MIN_MM * LATTICE_PER_MM)
        return ST_ENOTFACE;
    if (q->noise_mm > QUALITY_NOISE_MAX_MM || f->spikes > QUALITY_SPIKES_MAX * m->nv ||
        q->coverage < QUALITY_COVER_MIN)
        return ST_EQUALITY;
    return ST_OK;
}

/* Is the face turned away from the scanner?  The frame's pose maps the scanner's axes to the
 * face's. */
static bool turned(const struct pose *p)
{
    const double *r = p->r;
    const double pitch = series_degrees(r[7], sqrt(r[6] * r[6] + r[8] * r[8]));

    return fabs(series_degrees(r[6], r[8])) > SURFACE_YAW_DEG ||
           fabs(pitch) > SURFACE_TILT_DEG ||
           fabs(series_degrees(r[3], r[4])) > SURFACE_TILT_DEG;
}

/* The share of the outline below which a third of it is missing.  The other defects begin
 * (SURFACE_NOISY_MM, ...) at the density at which q->score begins to fall, at more noise than 99 of 100
 * scans of a good scanner have (0.51 mm), and at rotations beyond those that align_search() is
 * made for. */
#define QUALITY_INCOMPLETE_SHARE 0.7

unsigned quality_reasons(const struct surface_quality *q, const struct frame *frame)
{
    unsigned bits = 0;

    bits |= q->density_mm > SURFACE_SPARSE_MM ? 1U << SURFACE_SPARSE : 0;
    bits |= q->noise_mm > SURFACE_NOISY_MM ? 1U << SURFACE_NOISY : 0;
    bits |= q->coverage < QUALITY_INCOMPLETE_SHARE ? 1U << SURFACE_INCOMPLETE : 0;
    if (frame == NULL)
        return bits;
    bits |= turned(&frame->pose) ? 1U << SURFACE_OBLIQUE : 0;
    return bits;
}
