#include "disparity.h"

#include <stdbool.h>
#include <string.h>

#include "locate.h"

/* A sum and what was lost in rounding it: Neumaier, "Rundungsfehleranalyse einiger
 * Verfahren zur Summation endlicher Summen", ZAMM 54, 1974, with Knuth's exact error of an
 * addition in place of a branch on which of the two is larger. */
struct sum {
    double value, lost;
};

static inline void sum_add(struct sum *s, double x)
{
    const double t = s->value + x, got = t - s->value;

    s->lost += (s->value - (t - got)) + (x - got);
    s->value = t;
}

static inline double sum_total(const struct sum *s)
{
    return s->value + s->lost;
}

static inline double least(double a, double b)
{
    return a < b ? a : b;
}

static inline double most(double a, double b)
{
    return a > b ? a : b;
}

/* yes where it holds, else no, without a branch. */
static inline double disparity_choose(bool holds, double yes, double no)
{
    uint64_t y, n;

    memcpy(&y, &yes, sizeof y);
    memcpy(&n, &no, sizeof n);
    n ^= (n ^ y) & -(uint64_t)holds;
    memcpy(&no, &n, sizeof no);
    return no;
}

/* The mean of |gap| over a triangle, times 3.
 * One sign throughout: the plain sum (Fig. 9 a-c: prisms and pyramids).  Else one corner is
 * alone on its side of zero (d, e), at the height w; the line of zeros cuts off its tip of
 * the triangle, in area the share w^2 / ((w + |mid|) (below + above)), over which |gap|
 * falls from w to 0: a pyramid.  The signed sum takes the tip from the wedge (f) beyond
 * the line, so the tip is added twice.  In a good fit very many triangles are cut, at random:
 * the sign cases are separated without branches. */
static inline double mean3(double a, double b, double c)
{
    const double lo = least(least(a, b), c), hi = most(most(a, b), c);
    const double mid = most(least(a, b), least(most(a, b), c));
    const double below = -lo, above = hi, inner = fabs(mid);
    const bool low = (mid > 0) | ((mid == 0) & (below < above)); /* the lowest is alone */
    const double w = disparity_choose(low, below, above),
                 other = disparity_choose(low, above, below);
    const double tip = w * w * w / ((w + inner) * (below + above));

    /* (Where no sign changes the tip may be no number; it is not chosen.) */
    return disparity_choose((lo < 0) & (hi > 0), 2 * tip + (inner + other - w),
                            fabs(lo + hi + mid));
}

double disparity_prism(double area, double a, double b, double c)
{
    return area * mean3(a, b, c) / 3;
}

/* Over a triangle with a corner alone on its side of zero, the line of zeros cuts off that
 * corner's tip: a triangle itself, with the gap (g0, 0, 0) and u linear on it.  The integral
 * of the product of two linear functions over a triangle is
 *     area / 12 (sum of the one * sum of the other + sum of the products at the corners).
 * Beyond the line the sign is the other, so |.| is the tip and, with its sign turned, the whole
 * less the tip. */
double disparity_prism_weighted(double area, const double gap[3], const double u[3])
{
    const double whole = (gap[0] + gap[1] + gap[2]) * (u[0] + u[1] + u[2]) +
                         gap[0] * u[0] + gap[1] * u[1] + gap[2] * u[2];

    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double g = gap[i], a = gap[j], b = gap[k];

        if ((g > 0 && a <= 0 && b <= 0 && a + b < 0) ||
            (g < 0 && a >= 0 && b >= 0 && a + b > 0)) {
            const double s = g / (g - a), t = g / (g - b); /* the line, on both sides */
            const double tip =
                s * t * g * (4 * u[i] + s * (u[j] - u[i]) + t * (u[k] - u[i]));

            return area / 12 * (fabs(tip) + fabs(whole - tip));
        }
    }
    return area / 12 * fabs(whole);
}

/* struct disparity_vertex's gap, at a vertex that lies at loc in the other mesh. */
static inline double reported(double gap, const struct surface *other,
                              struct location loc)
{
    if (loc.where == LOCATE_OUTSIDE)
        return NAN;
    return !other->bridge[loc.he / 3] || holes_measured(&other->mesh, other->bridge, loc)
               ? gap
               : INFINITY; /* (Nearly always the former: no call.) */
}

void disparity_gaps(const struct surface *own, const struct surface *other,
                    const struct location *loc, bool above, double *gap)
{
    const double sign = above ? 1 : -1;

    for (uint32_t v = 0; v < own->mesh.nv; v++)
        gap[v] = reported(sign * (own->mesh.z[v] - gap[v]), other, loc[v]);
}

/* u at a's heights. */
static void disparity_weigh(const uint32_t *b_vertex, const struct disparity_side *a,
                            const struct disparity_side *b,
                            const struct disparity_weight *weight,
                            struct disparity_vertex *vertex)
{
    const struct mesh *ma = &a->surface->mesh, *mb = &b->surface->mesh;

    for (uint32_t v = 0; v < ma->nv; v++)
        if (isfinite(vertex[v].gap))
            vertex[v].u = weight->at(weight->arg, ma->xy[v].x, ma->xy[v].y, ma->z[v]);
    for (uint32_t v = 0; v < mb->nv; v++) {
        struct disparity_vertex *const d = &vertex[b_vertex[v]];

        if (b_vertex[v] >= ma->nv && isfinite(d->gap))
            d->u = weight->at(weight->arg, mb->xy[v].x, mb->xy[v].y, mb->z[v] - d->gap);
    }
}

static void disparity_gaps_along(const uint32_t *b_vertex, const struct disparity_side *a,
                                 const struct disparity_side *b,
                                 struct disparity_vertex *vertex)
{
    const struct surface *sa = a->surface, *sb = b->surface;

    for (uint32_t v = 0; v < sa->mesh.nv; v++)
        vertex[v] = (struct disparity_vertex){a->gap[v], sa->spacing[v], 0};
    for (uint32_t v = 0; v < sb->mesh.nv; v++) {
        struct disparity_vertex *const d = &vertex[b_vertex[v]];

        if (b_vertex[v] >= sa->mesh.nv) {
            *d = (struct disparity_vertex){b->gap[v], sb->spacing[v], 0};
        } else { /* a point of both: bridged or outside if either says so */
            d->gap = isfinite(d->gap) ? b->gap[v] : d->gap;
            d->spacing = d->spacing > sb->spacing[v] ? d->spacing : sb->spacing[v];
        }
    }
}

/* Sums over the triangles.  Areas are twice the area, whole square lattice units: all of a
 * hull's are below 2^52, so they are exact. */
struct totals {
    struct sum volume, weighted, weights; /* six times, twice, six times */
    double common;
};

static struct totals add_triangles(const struct mesh *general,
                                   const struct disparity_vertex *vertex, bool weighted)
{
    const uint32_t *const org = general->org;
    const uint32_t nv = general->nv, nh = 3 * general->nt;
    struct totals t = {{0, 0}, {0, 0}, {0, 0}, 0};

    for (uint32_t h = 0; h < nh; h += 3) {
        const uint32_t i = org[h], j = org[h + 1], k = org[h + 2];
        double area, volume;

        if (__builtin_expect((i == nv) | (j == nv) | (k == nv), 0))
            continue;
        if (__builtin_expect(!disparity_common(general, vertex, h, &area), 0))
            continue;
        t.common += area;
        volume = area * mean3(vertex[i].gap, vertex[j].gap, vertex[k].gap);
        sum_add(&t.volume, volume);
        if (weighted) {
            const double gap[3] = {vertex[i].gap, vertex[j].gap, vertex[k].gap};
            const double u[3] = {(double)vertex[i].u, (double)vertex[j].u,
                                 (double)vertex[k].u};

            sum_add(&t.weighted, disparity_prism_weighted(area, gap, u));
            sum_add(&t.weights, area * (u[0] + u[1] + u[2]));
        }
    }
    return t;
}

void disparity_measure(const struct mesh *general, const uint32_t *b_vertex,
                       const struct disparity_side *a, const struct disparity_side *b,
                       const struct disparity_weight *weight, double per_mm,
                       struct disparity_vertex *vertex, struct disparity *out)
{
    const double mm2 = 1 / (per_mm * per_mm);
    struct totals t;
    double share;

    memset(out, 0, sizeof *out);
    disparity_gaps_along(b_vertex, a, b, vertex);
    if (weight != NULL)
        disparity_weigh(b_vertex, a, b, weight, vertex);
    t = add_triangles(general, vertex, weight != NULL);
    out->volume_mm3 = sum_total(&t.volume) / 6 * mm2 / per_mm;
    out->area_mm2 = 0.5 * t.common * mm2;
    if (t.common > 0)
        out->plain_mm = sum_total(&t.volume) / (3 * t.common) / per_mm;
    out->weighted_mm = out->plain_mm;
    if (weight != NULL) {
        const double weights = sum_total(&t.weights);

        out->weighted_mm =
            weights > 0 ? 3 * sum_total(&t.weighted) / weights / per_mm : 0;
    }
    share = a->surface->measured > 0 ? 0.5 * t.common / a->surface->measured : 0;
    out->overlap = share < 1 ? share : 1;
}
