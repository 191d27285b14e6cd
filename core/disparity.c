#include "disparity.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "holes.h"
#include "locate.h"
#include "mesh.h"
#include "predicates.h"

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

/* The mean of |gap| over a triangle, times 3.
 * One sign throughout: the plain sum (Fig. 9 a, b: prism and pyramids).  Else one corner p
 * is alone on its side of zero (d, e; of two, the one farther off), and cuts off the tip
 * of the triangle, in area the share p^2 / ((p - q) (p - r)), over which |gap| falls from
 * |p| to 0: a pyramid.  The signed sum counts the tip once with the wrong sign, so it is
 * added twice: that makes the wedge (f) of the rest.  Nearly all cells of a good fit are
 * cut, at random: the sign cases are told apart without branches. */
static inline double mean3(double a, double b, double c)
{
    const double least = a < b ? a : b, most = a < b ? b : a;
    const double lo = least < c ? least : c, hi = most < c ? c : most;
    const double inner = most < c ? most : c, mid = least < inner ? inner : least;
    const bool below = (mid > 0) | ((mid == 0) & (lo + hi < 0)); /* lo is alone, else hi */
    const double p = below ? lo : hi, r = below ? hi : lo;
    const double total = (lo + hi) + mid, cut = ((lo < 0) & (hi > 0)) ? 1 : 0;
    const double share = p * p / ((p - mid) * (p - r) + (1 - cut));

    return fabs(total) * (1 - cut) + cut * (2 * fabs(p) * share + (below ? total : -total));
}

double disparity_cell(double area, double a, double b, double c)
{
    return area * mean3(a, b, c) / 3;
}

/* Does the other surface have something measured where this vertex lies? */
static bool measured_at(const struct mesh *m, const uint8_t *bridge, struct location loc)
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

/* The gap as disparity_vertex tells it, at a vertex that lies at loc in the other mesh. */
static inline double told(double gap, const struct disparity_side *other,
                          struct location loc)
{
    if (loc.where == LOCATE_OUTSIDE)
        return NAN;
    return measured_at(other->mesh, other->bridge, loc) ? gap : INFINITY;
}

static void gaps(const uint32_t *b_vertex, const struct disparity_side *a,
                 const struct disparity_side *b, struct disparity_vertex *vertex)
{
    for (uint32_t v = 0; v < a->mesh->nv; v++) {
        vertex[v].gap = told(a->other[v] - a->mesh->z[v], b, a->loc[v]);
        vertex[v].spacing = a->spacing[v];
    }
    for (uint32_t v = 0; v < b->mesh->nv; v++) {
        struct disparity_vertex *const d = &vertex[b_vertex[v]];
        const double gap = told(b->mesh->z[v] - b->other[v], a, b->loc[v]);

        if (b_vertex[v] >= a->mesh->nv) {
            d->gap = gap;
            d->spacing = b->spacing[v];
        } else { /* a point of both: each has its say */
            d->gap = isfinite(d->gap) ? gap : d->gap;
            d->spacing = d->spacing > b->spacing[v] ? d->spacing : b->spacing[v];
        }
    }
}

/* Sums over the cells.  Areas are twice the area, in whole square lattice units: all of a
 * hull's are below 2^52. */
struct totals {
    struct sum volume, weighted, weights; /* six times, six times, twice */
    int64_t common, bridged, outside;
};

static void weigh(struct totals *t, const struct disparity_weight *weight, struct ivec2 p,
                  struct ivec2 q, struct ivec2 r, double area, double volume)
{
    const double x = ((double)p.x + (double)q.x + (double)r.x) / 3;
    const double y = ((double)p.y + (double)q.y + (double)r.y) / 3;
    const double u = weight->at(weight->arg, x, y);

    sum_add(&t->weighted, u * volume);
    sum_add(&t->weights, u * area);
}

static void add_cells(const struct mesh *general, const struct disparity_vertex *vertex,
                      const struct disparity_weight *weight, struct totals *t,
                      struct disparity *out)
{
    const struct ivec2 *const xy = general->xy;
    const uint32_t nv = general->nv;

    for (uint32_t h = 0; h < 3 * general->nt; h += 3) {
        const uint32_t i = general->org[h], j = general->org[h + 1], k = general->org[h + 2];
        double spread, volume;
        int64_t area;

        if (__builtin_expect((i == nv) | (j == nv) | (k == nv), 0))
            continue;
        area = orient2d(xy[i], xy[j], xy[k]);
        spread = vertex[i].gap + vertex[j].gap + vertex[k].gap;
        if (__builtin_expect(!isfinite(spread), 0)) {
            const bool outside = isnan(spread);

            out->outside += outside;
            out->bridged += !outside;
            *(outside ? &t->outside : &t->bridged) += area;
            continue;
        }
        spread = (double)vertex[i].spacing + (double)vertex[j].spacing +
                 (double)vertex[k].spacing;
        if (__builtin_expect(holes_wide(xy[i], xy[j], xy[k], spread), 0)) {
            out->bridged++;
            t->bridged += area;
            continue;
        }
        out->cells++;
        t->common += area;
        volume = (double)area * mean3(vertex[i].gap, vertex[j].gap, vertex[k].gap);
        sum_add(&t->volume, volume);
        if (weight != NULL)
            weigh(t, weight, xy[i], xy[j], xy[k], (double)area, volume);
    }
}

void disparity_measure(const struct mesh *general, const uint32_t *b_vertex,
                       const struct disparity_side *a, const struct disparity_side *b,
                       const struct disparity_weight *weight, double per_mm,
                       struct disparity_vertex *vertex, struct disparity *out)
{
    const double mm2 = 1 / (per_mm * per_mm);
    struct totals t = {{0, 0}, {0, 0}, {0, 0}, 0, 0, 0};
    double share;

    memset(out, 0, sizeof *out);
    gaps(b_vertex, a, b, vertex);
    add_cells(general, vertex, weight, &t, out);
    out->volume_mm3 = sum_total(&t.volume) / 6 * mm2 / per_mm;
    out->area_mm2 = 0.5 * (double)t.common * mm2;
    out->bridged_mm2 = 0.5 * (double)t.bridged * mm2;
    out->outside_mm2 = 0.5 * (double)t.outside * mm2;
    if (t.common > 0)
        out->plain_mm = sum_total(&t.volume) / (3 * (double)t.common) / per_mm;
    out->weighted_mm = out->plain_mm;
    if (weight != NULL) {
        const double weights = sum_total(&t.weights);

        out->weighted_mm =
            weights > 0 ? sum_total(&t.weighted) / (3 * weights) / per_mm : 0;
    }
    share = a->measured > 0 ? 0.5 * (double)t.common / a->measured : 0;
    out->overlap = share < 1 ? share : 1;
}
