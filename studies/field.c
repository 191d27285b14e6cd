#include "field.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "lab.h"
#include "lattice.h"
#include "mesh.h"

/* For a square of a half side up to EXACT mm the planes are found from its own triangles.
 * Larger ones lie in one that is prepared: of sides from SIDE on, each level's larger by the
 * fourth root of 2, at each quarter of the side, over the hull and a margin round it. */
#define EXACT       0.8
#define LEVELS      19
#define SIDE        2.0
#define GROWTH      1.189207115002721
#define PARTS       4
#define MARGIN_MOST 64.0
#define RING        4.0
#define SLACK       2e-5 /* mm: more than a float loses of 200 mm */

struct square {
    float sx, sy, lo, hi;
};

struct level {
    double side, step, x, y;
    int wide, high;
    struct square *square; /* [high][wide] */
};

struct triangle {
    struct dvec3 p[3];
    double sx, sy;     /* its slope */
    double edge[3][3]; /* a x + b y + c: how far inside an edge, mm */
};

/* Which triangles meet a bucket: square, round the hull and what is near it. */
#define BUCKET 1.0
#define NEAR   120.0

struct field {
    size_t nt;
    struct triangle *triangle;
    struct level level[LEVELS];
    double x, y; /* of the buckets */
    int wide, high;
    uint32_t *first, *member; /* bucket b: member[first[b + 1]..first[b + 2] - 1] */
};

/* ---- the triangles */

static void add(struct field *f, struct dvec3 a, struct dvec3 b, struct dvec3 c)
{
    const double x1 = b.x - a.x, y1 = b.y - a.y, x2 = c.x - a.x, y2 = c.y - a.y;
    const double area = x1 * y2 - x2 * y1, z1 = b.z - a.z, z2 = c.z - a.z;
    struct triangle *const t = &f->triangle[f->nt++];

    *t = (struct triangle){
        {a, b, c}, (z1 * y2 - z2 * y1) / area, (x1 * z2 - x2 * z1) / area, {{0}}};
    for (int e = 0; e < 3; e++) {
        const struct dvec3 p = t->p[e], q = t->p[(e + 1) % 3];
        const double dx = q.x - p.x, dy = q.y - p.y;
        const double per = (area > 0 ? 1 : -1) / sqrt(dx * dx + dy * dy);

        t->edge[e][0] = -dy * per;
        t->edge[e][1] = dx * per;
        t->edge[e][2] = (dy * p.x - dx * p.y) * per;
    }
}

static struct dvec3 at(const struct mesh *m, uint32_t v)
{
    return lattice_to_mm(m->xy[v], m->z[v]);
}

static void collect(struct field *f, const struct mesh *m)
{
    struct dvec3 middle = {0, 0, 0};
    double hull = 0;

    f->triangle = lab_alloc(3 * (size_t)m->nt, sizeof *f->triangle);
    for (uint32_t t = 0; t < m->nt; t++)
        if (!mesh_is_ghost(m, t))
            add(f, at(m, m->org[3 * t]), at(m, m->org[3 * t + 1]),
                at(m, m->org[3 * t + 2]));
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (m->org[mesh_prev(h)] == m->nv) { /* a ghost's hull edge: clockwise */
            middle = vec_along(middle, 1, at(m, m->org[h]));
            hull++;
        }
    middle = (struct dvec3){middle.x / hull, middle.y / hull, 0};
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (m->org[mesh_prev(h)] == m->nv) {
            const struct dvec3 a = at(m, m->org[h]), b = at(m, mesh_dest(m, h));
            struct dvec3 far_a = vec_along(middle, RING, vec_sub(a, middle));
            struct dvec3 far_b = vec_along(middle, RING, vec_sub(b, middle));

            far_a.z = a.z;
            far_b.z = b.z;
            add(f, a, far_a, far_b);
            add(f, a, far_b, b);
        }
}

/* ---- the height */

static void bounds(const struct triangle *t, double lo[2], double hi[2])
{
    lo[0] = fmin(fmin(t->p[0].x, t->p[1].x), t->p[2].x);
    hi[0] = fmax(fmax(t->p[0].x, t->p[1].x), t->p[2].x);
    lo[1] = fmin(fmin(t->p[0].y, t->p[1].y), t->p[2].y);
    hi[1] = fmax(fmax(t->p[0].y, t->p[1].y), t->p[2].y);
}

static int clamp(double x, int n)
{
    return x < 0 ? 0 : x >= n ? n - 1 : (int)x;
}

static double height(const struct triangle *t, double x, double y)
{
    return t->p[0].z + t->sx * (x - t->p[0].x) + t->sy * (y - t->p[0].y);
}

/* Count the members of each bucket, or enter them. */
static void fill(struct field *f, bool enter)
{
    for (size_t k = 0; k < f->nt; k++) {
        double lo[2], hi[2];

        bounds(&f->triangle[k], lo, hi);
        for (int j = clamp((lo[1] - f->y) / BUCKET, f->high);
             j <= clamp((hi[1] - f->y) / BUCKET, f->high); j++)
            for (int i = clamp((lo[0] - f->x) / BUCKET, f->wide);
                 i <= clamp((hi[0] - f->x) / BUCKET, f->wide); i++) {
                uint32_t *const n = &f->first[j * f->wide + i + 1];

                if (enter)
                    f->member[--*n] = (uint32_t)k;
                else
                    ++*n;
            }
    }
}

static void sort_into_buckets(struct field *f, const double lo[2], const double hi[2])
{
    size_t buckets;

    f->x = lo[0];
    f->y = lo[1];
    f->wide = (int)((hi[0] - lo[0]) / BUCKET) + 1;
    f->high = (int)((hi[1] - lo[1]) / BUCKET) + 1;
    buckets = (size_t)f->wide * (size_t)f->high;
    f->first = lab_alloc(buckets + 2, sizeof *f->first);
    fill(f, false);
    for (size_t b = 1; b <= buckets; b++)
        f->first[b] += f->first[b - 1];
    f->first[buckets + 1] = f->first[buckets];
    f->member = lab_alloc(f->first[buckets], sizeof *f->member);
    fill(f, true); /* first[b + 1] is now where bucket b begins */
}

/* The bucket at (x, y), or the one nearest. */
static size_t bucket(const struct field *f, double x, double y)
{
    return (size_t)clamp((y - f->y) / BUCKET, f->high) * (size_t)f->wide +
           (size_t)clamp((x - f->x) / BUCKET, f->wide);
}

/* How far inside the triangle's edges, mm; and, of the square round (x, y), its worst place. */
static double inside(const struct triangle *t, double x, double y, double r)
{
    double least = (double)INFINITY;

    for (int e = 0; e < 3; e++) {
        const double *const k = t->edge[e];

        least = fmin(least, k[0] * x + k[1] * y + k[2] - r * (fabs(k[0]) + fabs(k[1])));
    }
    return least;
}

static const struct triangle *find(const struct field *f, double x, double y)
{
    const size_t b = bucket(f, x, y);
    const struct triangle *best = NULL;
    double most = -1e-9;

    for (uint32_t n = f->first[b + 1]; n < f->first[b + 2]; n++) {
        const struct triangle *const t = &f->triangle[f->member[n]];
        const double in = inside(t, x, y, 0);

        if (in >= 0)
            return t;
        if (in > most) {
            most = in;
            best = t;
        }
    }
    return best;
}

double field_at(const struct field *f, double x, double y)
{
    const struct triangle *const t = find(f, x, y);

    return t != NULL ? height(t, x, y) : (double)NAN;
}

/* ---- the squares */

struct polygon {
    int n;
    double p[8][2];
};

/* Leave the part of a polygon where sign * (coordinate k) <= sign * limit. */
static void clip(struct polygon *g, int k, double sign, double limit)
{
    const struct polygon in = *g;
    int beyond = 0;

    for (int i = 0; i < in.n; i++)
        beyond += sign * (in.p[i][k] - limit) > 0;
    if (beyond == 0)
        return;
    g->n = 0;
    for (int i = 0; i < in.n && beyond < in.n; i++) {
        const double *const p = in.p[i], *const q = in.p[i + 1 < in.n ? i + 1 : 0];
        const double a = sign * (p[k] - limit), b = sign * (q[k] - limit);

        if (a <= 0) {
            g->p[g->n][0] = p[0];
            g->p[g->n++][1] = p[1];
        }
        if ((a < 0 && b > 0) || (a > 0 && b < 0)) {
            const double s = a / (a - b);

            g->p[g->n][k] = limit;
            g->p[g->n++][1 - k] = p[1 - k] + s * (q[1 - k] - p[1 - k]);
        }
    }
}

static double area(const struct polygon *g)
{
    double sum = 0;

    for (int i = 1; i + 1 < g->n; i++)
        sum += (g->p[i][0] - g->p[0][0]) * (g->p[i + 1][1] - g->p[0][1]) -
               (g->p[i + 1][0] - g->p[0][0]) * (g->p[i][1] - g->p[0][1]);
    return 0.5 * fabs(sum);
}

/* The part of a triangle in the square with the corner (x, y). */
static void cut_out(const struct triangle *t, double x, double y, double side,
                    struct polygon *out)
{
    *out = (struct polygon){
        3, {{t->p[0].x, t->p[0].y}, {t->p[1].x, t->p[1].y}, {t->p[2].x, t->p[2].y}}};
    clip(out, 0, -1, x);
    clip(out, 0, 1, x + side);
    clip(out, 1, -1, y);
    clip(out, 1, 1, y + side);
}

/* A square's sums, then, over its mean slope, the least and largest height. */
struct tally {
    double area, sx, sy, lo, hi;
};

static void take(const struct level *l, int i, int j, const struct triangle *t,
                 const struct polygon *g, bool extremes, struct tally *s)
{
    if (!extremes) {
        const double a = area(g);

        s->area += a;
        s->sx += a * t->sx;
        s->sy += a * t->sy;
        return;
    }
    for (int k = 0; k < g->n; k++) {
        const struct square *const q =
            &l->square[(size_t)j * (size_t)l->wide + (size_t)i];
        const double x = g->p[k][0], y = g->p[k][1];
        const double mx = l->x + l->step * i + l->side / 2,
                     my = l->y + l->step * j + l->side / 2;
        const double rest =
            height(t, x, y) - (double)q->sx * (x - mx) - (double)q->sy * (y - my);

        s->lo = fmin(s->lo, rest);
        s->hi = fmax(s->hi, rest);
    }
}

static void spread(const struct level *l, const struct triangle *t, bool extremes,
                   struct tally *sum)
{
    const struct polygon whole = {
        3, {{t->p[0].x, t->p[0].y}, {t->p[1].x, t->p[1].y}, {t->p[2].x, t->p[2].y}}};
    double lo[2], hi[2];

    bounds(t, lo, hi);
    if (hi[0] < l->x || hi[1] < l->y)
        return;
    for (int i = clamp((lo[0] - l->x - l->side) / l->step, l->wide);
         i <= clamp((hi[0] - l->x) / l->step, l->wide); i++) {
        const double x = l->x + l->step * i;
        struct polygon strip = whole;
        double from = (double)INFINITY, to = -(double)INFINITY;

        clip(&strip, 0, -1, x);
        clip(&strip, 0, 1, x + l->side);
        for (int k = 0; k < strip.n; k++) {
            from = fmin(from, strip.p[k][1]);
            to = fmax(to, strip.p[k][1]);
        }
        if (strip.n < 3 || to < l->y)
            continue;
        for (int j = clamp((from - l->y - l->side) / l->step, l->high);
             j <= clamp((to - l->y) / l->step, l->high); j++) {
            const double y = l->y + l->step * j;
            struct polygon part = strip;

            clip(&part, 1, -1, y);
            clip(&part, 1, 1, y + l->side);
            if (part.n >= 3)
                take(l, i, j, t, &part, extremes,
                     &sum[(size_t)j * (size_t)l->wide + (size_t)i]);
        }
    }
}

static void make_level(const struct field *f, double side, const double lo[2],
                       const double hi[2], struct level *l)
{
    const double margin = fmin(8 * side, MARGIN_MOST);
    struct tally *sum;
    size_t n;

    l->side = side;
    l->step = side / PARTS;
    l->x = lo[0] - margin;
    l->y = lo[1] - margin;
    l->wide = (int)ceil((hi[0] + margin - l->x) / l->step);
    l->high = (int)ceil((hi[1] + margin - l->y) / l->step);
    n = (size_t)l->wide * (size_t)l->high;
    l->square = lab_alloc(n, sizeof *l->square);
    sum = lab_alloc(n, sizeof *sum);
    for (size_t k = 0; k < f->nt; k++)
        spread(l, &f->triangle[k], false, sum);
    for (size_t i = 0; i < n; i++) {
        l->square[i].sx = (float)(sum[i].sx / sum[i].area);
        l->square[i].sy = (float)(sum[i].sy / sum[i].area);
        sum[i].lo = (double)INFINITY;
        sum[i].hi = -(double)INFINITY;
    }
    for (size_t k = 0; k < f->nt; k++)
        spread(l, &f->triangle[k], true, sum);
    for (size_t i = 0; i < n; i++) {
        /* (Beyond the ring: no number, and no enclosure.) */
        if (sum[i].area < (1 - 1e-6) * side * side)
            sum[i].lo = (double)NAN;
        l->square[i].lo = (float)(sum[i].lo - SLACK);
        l->square[i].hi = (float)(sum[i].hi + SLACK);
    }
    free(sum);
}

/* ---- enclosures */

#define MEET 64 /* triangles with a small square, at most */

struct part {
    const struct triangle *t;
    struct polygon g; /* what lies in the square */
};

/* The triangles that meet the square round (x, y), each once; returns how many, or MEET. */
static int meet(const struct field *f, double x, double y, double r, struct part *part)
{
    int n = 0;

    for (int j = clamp((y - r - f->y) / BUCKET, f->high);
         j <= clamp((y + r - f->y) / BUCKET, f->high); j++)
        for (int i = clamp((x - r - f->x) / BUCKET, f->wide);
             i <= clamp((x + r - f->x) / BUCKET, f->wide); i++) {
            const size_t b = (size_t)j * (size_t)f->wide + (size_t)i;

            for (uint32_t k = f->first[b + 1]; k < f->first[b + 2]; k++) {
                const struct triangle *const t = &f->triangle[f->member[k]];
                bool known = inside(t, x, y, -r) < 0; /* beyond one of its edges */

                for (int p = 0; p < n && !known; p++)
                    known = part[p].t == t;
                if (known)
                    continue;
                part[n].t = t;
                cut_out(t, x - r, y - r, 2 * r, &part[n].g);
                if (part[n].g.n >= 3 && ++n == MEET)
                    return n;
            }
        }
    return n;
}

/* The planes of a small square: over the mean slope of what it meets. */
static bool enclose(const struct field *f, double x, double y, double r,
                    struct field_plane *out)
{
    const struct triangle *const middle = find(f, x, y);
    struct part part[MEET];
    double all = 0;
    int n;

    *out = (struct field_plane){x, y, 0, 0, (double)INFINITY, -(double)INFINITY};
    if (middle == NULL)
        return false;
    if (inside(middle, x, y, r) >= 0) {
        out->sx = middle->sx;
        out->sy = middle->sy;
        out->lo = height(middle, x, y) - SLACK;
        out->hi = out->lo + 2 * SLACK;
        return true;
    }
    if ((n = meet(f, x, y, r, part)) == MEET)
        return false;
    for (int i = 0; i < n; i++) {
        const double a = area(&part[i].g);

        all += a;
        out->sx += a * part[i].t->sx;
        out->sy += a * part[i].t->sy;
    }
    if (all < (1 - 1e-6) * 4 * r * r)
        return false;
    out->sx /= all;
    out->sy /= all;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < part[i].g.n; k++) {
            const double *const p = part[i].g.p[k];
            const double rest = height(part[i].t, p[0], p[1]) - out->sx * (p[0] - x) -
                                out->sy * (p[1] - y);

            out->lo = fmin(out->lo, rest - SLACK);
            out->hi = fmax(out->hi, rest + SLACK);
        }
    return true;
}

bool field_enclose(const struct field *f, double x, double y, double r,
                   struct field_plane *out)
{
    if (r <= EXACT && enclose(f, x, y, r, out))
        return true;
    for (int k = 0; k < LEVELS; k++) {
        const struct level *const l = &f->level[k];
        const double i = floor((x - r - l->x) / l->step);
        const double j = floor((y - r - l->y) / l->step);
        const struct square *s;

        /* It begins less than a step before x - r, and ends beyond x + r. */
        if (2 * r > l->side - l->step || !(i >= 0 && j >= 0) || i >= l->wide ||
            j >= l->high)
            continue;
        s = &l->square[(size_t)j * (size_t)l->wide + (size_t)i];
        if (isnan(s->lo))
            continue;
        *out = (struct field_plane){l->x + l->step * i + l->side / 2,
                                    l->y + l->step * j + l->side / 2,
                                    (double)s->sx,
                                    (double)s->sy,
                                    (double)s->lo,
                                    (double)s->hi};
        return true;
    }
    return false;
}

struct field *field_new(const struct mesh *m)
{
    struct field *f = lab_alloc(1, sizeof *f);
    double lo[2] = {(double)INFINITY, (double)INFINITY}, hi[2] = {-lo[0], -lo[1]};
    double side = SIDE;

    collect(f, m);
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct dvec3 p = at(m, v);

        lo[0] = fmin(lo[0], p.x);
        lo[1] = fmin(lo[1], p.y);
        hi[0] = fmax(hi[0], p.x);
        hi[1] = fmax(hi[1], p.y);
    }
    sort_into_buckets(f, (double[2]){lo[0] - NEAR, lo[1] - NEAR},
                      (double[2]){hi[0] + NEAR, hi[1] + NEAR});
    for (int k = 0; k < LEVELS; k++, side *= GROWTH)
        make_level(f, side, lo, hi, &f->level[k]);
    return f;
}

void field_free(struct field *f)
{
    if (f == NULL)
        return;
    for (int k = 0; k < LEVELS; k++)
        free(f->level[k].square);
    free(f->triangle);
    free(f->first);
    free(f->member);
    free(f);
}
