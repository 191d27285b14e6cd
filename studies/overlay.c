#include "overlay.h"

#include <math.h>
#include <stdlib.h>

#include "lab.h"

/* b's triangles by the squares of a grid that their boxes meet: first[square] to
 * first[square + 1] in item. */
struct index {
    int side;
    double x, y, per;
    uint32_t *first, *item;
};

struct box {
    double x0, y0, x1, y1;
};

static struct box box_of(const struct mesh *m, uint32_t t)
{
    struct box b = {INFINITY, INFINITY, -INFINITY, -INFINITY};

    for (uint32_t i = 0; i < 3; i++) {
        const struct ivec2 p = m->xy[m->org[3 * t + i]];

        b = (struct box){fmin(b.x0, p.x), fmin(b.y0, p.y), fmax(b.x1, p.x),
                         fmax(b.y1, p.y)};
    }
    return b;
}

static int square(double at, double low, const struct index *x)
{
    const double k = (at - low) * x->per;

    return k <= 0 ? 0 : k >= x->side ? x->side - 1 : (int)k;
}

/* Count, then place: each triangle in all squares that its box meets. */
static void fill(const struct mesh *b, struct index *x)
{
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t t = 0; t < b->nt; t++) {
            const struct box w = box_of(b, mesh_is_ghost(b, t) ? 0 : t);

            if (mesh_is_ghost(b, t))
                continue;
            for (int j = square(w.y0, x->y, x); j <= square(w.y1, x->y, x); j++)
                for (int i = square(w.x0, x->x, x); i <= square(w.x1, x->x, x); i++)
                    if (pass == 0)
                        x->first[j * x->side + i + 1]++;
                    else
                        x->item[x->first[j * x->side + i]++] = t;
        }
        if (pass == 0) {
            for (int k = 0; k < x->side * x->side; k++)
                x->first[k + 1] += x->first[k];
            x->item = lab_alloc(x->first[x->side * x->side], sizeof *x->item);
        }
    }
    for (int k = x->side * x->side; k > 0; k--) /* they moved up by one */
        x->first[k] = x->first[k - 1];
    x->first[0] = 0;
}

static struct index index_make(const struct mesh *b)
{
    struct index x = {.side = (int)sqrt((double)b->nv) + 1};
    struct box all = {INFINITY, INFINITY, -INFINITY, -INFINITY};

    for (uint32_t v = 0; v < b->nv; v++) {
        const struct ivec2 p = b->xy[v];

        all = (struct box){fmin(all.x0, p.x), fmin(all.y0, p.y), fmax(all.x1, p.x),
                           fmax(all.y1, p.y)};
    }
    x.x = all.x0;
    x.y = all.y0;
    x.per = x.side / fmax(all.x1 - all.x0, all.y1 - all.y0);
    x.first = lab_alloc((size_t)(x.side * x.side) + 1, sizeof *x.first);
    fill(b, &x);
    return x;
}

/* ---- two triangles */

struct corner {
    double x, y, g; /* g: by which is clipped, >= 0 is kept; then the gap */
};

/* What of the polygon has g >= 0.  Room for n + 1. */
static size_t clip(const struct corner *p, size_t n, struct corner *out)
{
    size_t k = 0;

    for (size_t i = 0; i < n; i++) {
        const struct corner a = p[i], b = p[(i + 1) % n];

        if (a.g >= 0)
            out[k++] = a;
        if ((a.g < 0) != (b.g < 0) && a.g != 0 && b.g != 0) {
            const double t = a.g / (a.g - b.g);

            out[k++] = (struct corner){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), 0};
        }
    }
    return k;
}

/* The integral of g over a convex polygon, and its area: a fan of triangles. */
static double integrate(const struct corner *p, size_t n, double *area)
{
    double sum = 0;

    *area = 0;
    for (size_t i = 2; i < n; i++) {
        const double twice = (p[i - 1].x - p[0].x) * (p[i].y - p[0].y) -
                             (p[i - 1].y - p[0].y) * (p[i].x - p[0].x);

        *area += 0.5 * twice;
        sum += twice / 6 * (p[0].g + p[i - 1].g + p[i].g);
    }
    return sum;
}

/* Height over (x, y) of the plane through triangle t, from the corner o on. */
static double height(const struct mesh *m, uint32_t t, double x, double y)
{
    const uint32_t *v = &m->org[3 * t];
    const struct ivec2 o = m->xy[v[0]], p = m->xy[v[1]], q = m->xy[v[2]];
    const double ux = p.x - o.x, uy = p.y - o.y, vx = q.x - o.x, vy = q.y - o.y;
    const double dx = x - o.x, dy = y - o.y, det = ux * vy - uy * vx;
    const double s = (dx * vy - dy * vx) / det, r = (ux * dy - uy * dx) / det;

    return m->z[v[0]] + s * ((double)m->z[v[1]] - m->z[v[0]]) +
           r * ((double)m->z[v[2]] - m->z[v[0]]);
}

static double pair(const struct mesh *a, uint32_t ta, const struct mesh *b, uint32_t tb,
                   double *area)
{
    struct corner poly[2][10];
    double volume = 0, part;
    size_t n = 3, k;
    int cur = 0;

    for (uint32_t i = 0; i < 3; i++) {
        const struct ivec2 p = a->xy[a->org[3 * ta + i]];

        poly[0][i] = (struct corner){p.x, p.y, 0};
    }
    for (uint32_t e = 0; e < 3 && n >= 3; e++) {
        const struct ivec2 u = b->xy[b->org[3 * tb + e]];
        const struct ivec2 v = b->xy[b->org[3 * tb + (e + 1) % 3]];

        for (size_t i = 0; i < n; i++)
            poly[cur][i].g = ((double)v.x - u.x) * (poly[cur][i].y - u.y) -
                             ((double)v.y - u.y) * (poly[cur][i].x - u.x);
        n = clip(poly[cur], n, poly[1 - cur]);
        cur = 1 - cur;
    }
    *area = 0;
    if (n < 3)
        return 0;
    for (size_t i = 0; i < n; i++)
        poly[cur][i].g = height(b, tb, poly[cur][i].x, poly[cur][i].y) -
                         height(a, ta, poly[cur][i].x, poly[cur][i].y);
    (void)integrate(poly[cur], n, area);
    for (int side = 0; side < 2; side++) { /* above, then below */
        k = clip(poly[cur], n, poly[1 - cur]);
        volume += integrate(poly[1 - cur], k, &part);
        for (size_t i = 0; i < n; i++)
            poly[cur][i].g = -poly[cur][i].g;
    }
    return volume;
}

double overlay_volume(const struct mesh *a, const struct mesh *b, double *area)
{
    struct index x = index_make(b);
    uint32_t *seen = lab_alloc(b->nt, sizeof *seen);
    double volume = 0, part;

    *area = 0;
    for (uint32_t t = 0; t < a->nt; t++) {
        const struct box w = box_of(a, mesh_is_ghost(a, t) ? 0 : t);

        if (mesh_is_ghost(a, t))
            continue;
        for (int j = square(w.y0, x.y, &x); j <= square(w.y1, x.y, &x); j++)
            for (int i = square(w.x0, x.x, &x); i <= square(w.x1, x.x, &x); i++) {
                const int k = j * x.side + i;

                for (uint32_t s = x.first[k]; s < x.first[k + 1]; s++) {
                    if (seen[x.item[s]] == t + 1)
                        continue;
                    seen[x.item[s]] = t + 1;
                    volume += pair(a, t, b, x.item[s], &part);
                    *area += part;
                }
            }
    }
    free(seen);
    free(x.first);
    free(x.item);
    return volume;
}
