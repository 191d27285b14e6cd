#include "brute.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_link.h"
#include "predicates.h"

uint64_t brute_seed(const char *name)
{
    const char *given = getenv("SEED");
    const uint64_t seed = given != NULL ? strtoull(given, NULL, 0) : 20261121;

    printf("%s: SEED=%llu\n", name, (unsigned long long)seed);
    return seed;
}

int32_t brute_int(struct draw *r, int32_t lo, int32_t hi)
{
    const uint64_t span = (uint64_t)((int64_t)hi - lo) + 1;

    return (int32_t)(lo + (int64_t)(draw_next(r) % span));
}

void brute_shuffle(void *items, size_t n, size_t size, struct draw *r)
{
    unsigned char *at = items, t[64];

    assert(size <= sizeof t);
    for (size_t i = n; i-- > 1;) {
        unsigned char *a = at + i * size, *b = at + draw_next(r) % (i + 1) * size;

        memcpy(t, a, size);
        memmove(a, b, size);
        memcpy(b, t, size);
    }
}

static void *allocate(size_t n, size_t size)
{
    void *p = calloc(n, size);

    if (p == NULL)
        abort();
    return p;
}

/* ---- point sets */

/* Every (x, y) on the circle of radius 5 * 13 * 17 * 29 round the origin: 324 points. */
static size_t circle_points(struct ivec3 *out)
{
    const int64_t r = 5 * 13 * 17 * 29;
    size_t n = 0;

    for (int64_t x = -r; x <= r; x++) {
        const int64_t y2 = r * r - x * x;
        const int64_t y = (int64_t)llround(sqrt((double)y2));

        if (y * y != y2)
            continue;
        out[n++] = (struct ivec3){(int32_t)x, (int32_t)y, 0};
        if (y != 0)
            out[n++] = (struct ivec3){(int32_t)x, (int32_t)-y, 0};
    }
    return n;
}

static struct ivec3 one_point(enum brute_shape shape, size_t i, size_t n, struct draw *r)
{
    const int32_t side = (int32_t)ceil(sqrt((double)n));
    const int32_t far = 1 << 24;
    struct ivec3 p = {0, 0, 0};

    switch (shape) {
    case BRUTE_SMALL:
        p.x = brute_int(r, 0, side + 2);
        p.y = brute_int(r, 0, side + 2);
        break;
    case BRUTE_LATTICE:
        p.x = (int32_t)i % side * 700 - 3000;
        p.y = (int32_t)i / side * 700 + 100;
        break;
    case BRUTE_HULL_LINE:
        p.x = brute_int(r, 0, 40) * 1000;
        p.y = brute_int(r, 0, 30) * 1000;
        if (i % 2 == 0)
            *(i % 4 == 0 ? &p.x : &p.y) =
                brute_int(r, 0, 1) * (i % 4 == 0 ? 40000 : 30000);
        break;
    case BRUTE_CLUSTERS:
        p.x = (int32_t)(i % 3) * 5000000 + brute_int(r, 0, 300);
        p.y = (int32_t)(i % 5) * 3000000 + brute_int(r, 0, 300);
        break;
    case BRUTE_COLUMNS:
        p.x = (int32_t)(i / 2) * 1000;
        p.y = (i % 2 == 0 ? 0 : 100000) + brute_int(r, 0, 3000);
        break;
    case BRUTE_EXTREME:
        p.x = i % 3 == 0 ? brute_int(r, -1, 1) * far : brute_int(r, -far, far);
        p.y = i % 5 == 0 ? brute_int(r, -1, 1) * far : brute_int(r, -far, far);
        break;
    default:
        p.x = brute_int(r, -70000, 70000);
        p.y = brute_int(r, -70000, 70000);
    }
    return p;
}

static int by_xy(const void *a, const void *b)
{
    const struct ivec3 *p = a, *q = b;

    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    return p->y < q->y ? -1 : p->y > q->y;
}

static bool on_a_line(const struct ivec3 *p, size_t n)
{
    const struct ivec2 a = {p[0].x, p[0].y}, b = {p[n > 1].x, p[n > 1].y};

    for (size_t i = 2; i < n; i++)
        if (orient2d(a, b, (struct ivec2){p[i].x, p[i].y}) != 0)
            return false;
    return true;
}

static size_t some_points(enum brute_shape shape, size_t n, struct draw *r,
                          struct ivec3 *out)
{
    struct ivec3 *all = allocate(n + 324, sizeof *all);
    size_t m = 0, kept = 0;

    if (shape == BRUTE_CIRCLE)
        m = circle_points(all);
    else
        for (; m < n; m++)
            all[m] = one_point(shape, m, n, r);
    brute_shuffle(all, m, sizeof *all, r);
    m = m < n ? m : n;
    qsort(all, m, sizeof *all, by_xy);
    for (size_t i = 0; i < m; i++)
        if (i == 0 || by_xy(&all[i - 1], &all[i]) != 0)
            out[kept++] = all[i];
    brute_shuffle(out, kept, sizeof *out, r);
    for (size_t i = 0; i < kept; i++)
        out[i].z = (int32_t)(5000 * sin(out[i].x * 3e-5) * cos(out[i].y * 4e-5)) +
                   brute_int(r, -900, 900);
    free(all);
    return kept;
}

size_t brute_points(enum brute_shape shape, size_t n, struct draw *r, struct ivec3 *out)
{
    size_t kept;

    do
        kept = some_points(shape, n, r, out);
    while (on_a_line(out, kept));
    return kept;
}

/* ---- triangulation by definition */

/* The half-edge from u to v; UINT32_MAX if there is none. */
static uint32_t half_edge(const struct mesh *m, uint32_t u, uint32_t v)
{
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (m->org[h] == u && mesh_dest(m, h) == v)
            return h;
    return UINT32_MAX;
}

static void add_triangle(struct mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *org = &m->org[3 * m->nt++];

    org[0] = a;
    org[1] = b;
    org[2] = c;
}

/* The point on the left of ab whose circle through a and b is empty; nv if there is none. */
static uint32_t apex(const struct mesh *m, uint32_t a, uint32_t b)
{
    uint32_t best = m->nv;

    for (uint32_t c = 0; c < m->nv; c++) {
        if (orient2d(m->xy[a], m->xy[b], m->xy[c]) <= 0)
            continue;
        if (best == m->nv || incircle(m->xy[a], m->xy[b], m->xy[best], m->xy[c]))
            best = c;
    }
    return best;
}

/* A hull edge: the first point, and the nearest of those with all others on the left. */
static void first_edge(const struct mesh *m, uint32_t *a, uint32_t *b)
{
    *a = 0;
    for (uint32_t v = 1; v < m->nv; v++)
        if (lex_less(m->xy[v], m->xy[*a]))
            *a = v;
    *b = *a == 0;
    for (uint32_t v = 0; v < m->nv; v++) {
        const int64_t o = v == *a ? 1 : orient2d(m->xy[*a], m->xy[*b], m->xy[v]);

        if (o < 0 || (o == 0 && lex_less(m->xy[v], m->xy[*b])))
            *b = v;
    }
}

void brute_delaunay(const struct ivec3 *pts, size_t n, struct mesh *out)
{
    uint32_t a, b, c, finite;

    if (mesh_reserve(out, (uint32_t)n) != ST_OK)
        abort();
    out->nv = (uint32_t)n;
    for (uint32_t v = 0; v < n; v++) {
        out->xy[v] = (struct ivec2){pts[v].x, pts[v].y};
        out->z[v] = pts[v].z;
    }
    first_edge(out, &a, &b);
    if ((c = apex(out, a, b)) == out->nv)
        abort(); /* all on a line */
    add_triangle(out, a, b, c);
    for (uint32_t h = 0; h < 3 * out->nt; h++) { /* grows as triangles are added */
        a = mesh_dest(out, h);
        b = out->org[h];
        if (half_edge(out, a, b) == UINT32_MAX && (c = apex(out, a, b)) < out->nv)
            add_triangle(out, a, b, c);
    }
    finite = 3 * out->nt;
    for (uint32_t h = 0; h < finite; h++)
        if (half_edge(out, mesh_dest(out, h), out->org[h]) == UINT32_MAX)
            add_triangle(out, mesh_dest(out, h), out->org[h], out->nv);
    assert(out->nt == 2 * out->nv - 2);
    for (uint32_t h = 0; h < 3 * out->nt; h++) {
        out->twin[h] = half_edge(out, mesh_dest(out, h), out->org[h]);
        assert(out->twin[h] != UINT32_MAX);
        out->out[out->org[h]] = h;
    }
}

static void pair(struct mesh *m, uint32_t h, uint32_t org, uint32_t twin)
{
    m->org[h] = org;
    m->twin[h] = twin;
    m->twin[twin] = h;
    m->out[org] = h;
}

bool brute_flip(struct mesh *m, uint32_t h)
{
    const uint32_t k = m->twin[h], hn = mesh_next(h), hp = mesh_prev(h);
    const uint32_t kn = mesh_next(k), kp = mesh_prev(k);
    const uint32_t a = m->org[h], b = m->org[k], c = m->org[hp], d = m->org[kp];
    const uint32_t bc = m->twin[hn], ca = m->twin[hp], ad = m->twin[kn], db = m->twin[kp];

    if (a == m->nv || b == m->nv || c == m->nv || d == m->nv ||
        orient2d(m->xy[d], m->xy[c], m->xy[a]) <= 0 ||
        orient2d(m->xy[c], m->xy[d], m->xy[b]) <= 0)
        return false;
    pair(m, h, d, k);
    pair(m, hn, c, ca);
    pair(m, hp, a, ad);
    pair(m, k, c, h);
    pair(m, kn, d, db);
    pair(m, kp, b, bc);
    return true;
}

struct corners {
    struct ivec2 v[3];
};

static int by_corners(const void *a, const void *b)
{
    const struct corners *p = a, *q = b;

    for (int i = 0; i < 3; i++) {
        if (lex_less(p->v[i], q->v[i]))
            return -1;
        if (lex_less(q->v[i], p->v[i]))
            return 1;
    }
    return 0;
}

/* The real triangles, each beginning with its first corner, sorted. */
static struct corners *canonical(const struct mesh *m, size_t *n)
{
    struct corners *c = allocate(m->nt + 1, sizeof *c);

    *n = 0;
    for (uint32_t t = 0; t < m->nt; t++) {
        uint32_t h = 3 * t;

        if (mesh_is_ghost(m, t))
            continue;
        for (uint32_t i = 3 * t; i < 3 * t + 3; i++)
            if (lex_less(m->xy[m->org[i]], m->xy[m->org[h]]))
                h = i;
        c[*n].v[0] = m->xy[m->org[h]];
        c[*n].v[1] = m->xy[mesh_dest(m, h)];
        c[*n].v[2] = m->xy[m->org[mesh_prev(h)]];
        ++*n;
    }
    qsort(c, *n, sizeof *c, by_corners);
    return c;
}

/* Triangle n of the new order is the one of the old half-edge h, which becomes its first. */
static void renumber(const struct mesh *m, uint32_t h, uint32_t n, uint32_t *now,
                     uint32_t *was)
{
    for (uint32_t i = 0; i < 3; i++, h = mesh_next(h)) {
        assert(now[h] == UINT32_MAX && n < m->nt);
        now[h] = 3 * n + i;
        was[3 * n + i] = h;
    }
}

void brute_order(struct mesh *m, struct draw *r)
{
    const uint32_t halves = 3 * m->nt;
    uint32_t *now = malloc(halves * sizeof *now), *was = malloc(halves * sizeof *was);
    uint32_t *org = malloc(halves * sizeof *org), n = 0, first = 0;

    assert(now != NULL && was != NULL && org != NULL);
    memcpy(org, m->org, halves * sizeof *org);
    memset(now, 0xff, halves * sizeof *now);
    for (uint32_t h = 0; h < halves; h++)
        m->twin[h] = half_edge(m, mesh_dest(m, h), m->org[h]);
    while (m->org[mesh_prev(first)] != m->nv)
        first++;
    for (uint32_t h = first; now[h] == UINT32_MAX; h = mesh_next(m->twin[mesh_next(h)]))
        renumber(m, h, n++, now, was);
    while (n < m->nt) {
        uint32_t i = 0, gate;

        if (r != NULL)
            i = (uint32_t)brute_int(r, 0, (int32_t)(3 * n) - 1);
        while (now[gate = m->twin[was[i]]] != UINT32_MAX)
            i = (i + 1) % (3 * n);
        renumber(m, gate, n++, now, was);
    }
    for (uint32_t h = 0; h < halves; h++)
        m->org[h] = org[was[h]];
    memcpy(org, m->twin, halves * sizeof *org);
    for (uint32_t h = 0; h < halves; h++)
        m->twin[h] = now[org[was[h]]];
    free(now);
    free(was);
    free(org);
}

void brute_code(struct mesh *m)
{
    uint32_t *list = malloc(m->nt * sizeof *list), n = 0;

    assert(list != NULL);
    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (mesh_listed(m, h)) {
            assert(n + 2 <= m->nt);
            list[n++] = h;
            list[n++] = m->twin[h];
        }
    assert(n == m->nt);
    for (uint32_t t = 0; t < m->nt; t++) {
        if (m->org[3 * t + 2] == m->nv)
            m->twin[3 * t] = UINT32_MAX;
        else
            m->org[3 * t] = UINT32_MAX;
        m->org[3 * t + 1] = list[t];
        m->twin[3 * t + 1] = m->twin[3 * t + 2] = UINT32_MAX;
    }
    memset(m->out, 0xff, (m->nv + 1) * sizeof *m->out);
    free(list);
}

bool brute_same(const struct mesh *a, const struct mesh *b)
{
    size_t na, nb;
    struct corners *ca = canonical(a, &na), *cb = canonical(b, &nb);
    const bool same = a->nv == b->nv && na == nb && memcmp(ca, cb, na * sizeof *ca) == 0;

    free(ca);
    free(cb);
    return same;
}

bool brute_identical(const struct mesh *a, const struct mesh *b)
{
    const size_t n = a->nv, halves = 3 * (size_t)a->nt;

    return a->nv == b->nv && a->nt == b->nt &&
           memcmp(a->xy, b->xy, n * sizeof *a->xy) == 0 &&
           memcmp(a->z, b->z, n * sizeof *a->z) == 0 &&
           memcmp(a->org, b->org, halves * sizeof *a->org) == 0 &&
           memcmp(a->twin, b->twin, halves * sizeof *a->twin) == 0 &&
           memcmp(a->out, b->out, (n + 1) * sizeof *a->out) == 0;
}

/* ---- spanning tree */

/* Whether edge ab comes before edge cd: it is shorter or, with equal lengths, lexicographically
 * first by its first end point, then by the other. */
static bool edge_less(struct ivec2 a, struct ivec2 b, struct ivec2 c, struct ivec2 d)
{
    const int64_t abx = b.x - a.x, aby = b.y - a.y, cdx = d.x - c.x, cdy = d.y - c.y;
    const int64_t ab = abx * abx + aby * aby, cd = cdx * cdx + cdy * cdy;
    struct corners e = {{a, b, {0, 0}}}, f = {{c, d, {0, 0}}};

    if (ab != cd)
        return ab < cd;
    if (lex_less(b, a))
        e = (struct corners){{b, a, {0, 0}}};
    if (lex_less(d, c))
        f = (struct corners){{d, c, {0, 0}}};
    return by_corners(&e, &f) < 0;
}

void brute_prim(const struct mesh *m, uint32_t *parent)
{
    bool *in = allocate(m->nv, sizeof *in);
    uint32_t root = 0;

    for (uint32_t v = 1; v < m->nv; v++)
        if (lex_less(m->xy[v], m->xy[root]))
            root = v;
    parent[root] = root;
    in[root] = true;
    for (uint32_t k = 1; k < m->nv; k++) {
        uint32_t best = UINT32_MAX;

        for (uint32_t h = 0; h < 3 * m->nt; h++) {
            const uint32_t u = m->org[h], v = mesh_dest(m, h);

            if (u == m->nv || v == m->nv || !in[u] || in[v])
                continue;
            if (best == UINT32_MAX || edge_less(m->xy[u], m->xy[v], m->xy[m->org[best]],
                                                m->xy[mesh_dest(m, best)]))
                best = h;
        }
        assert(best != UINT32_MAX);
        in[mesh_dest(m, best)] = true;
        parent[mesh_dest(m, best)] = m->org[best];
    }
    free(in);
}

/* ---- location */

struct location brute_locate(const struct mesh *m, struct ivec2 q)
{
    struct location at = {UINT32_MAX, LOCATE_OUTSIDE};

    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        struct ivec2 a, b, c;
        int64_t o[3];

        if (mesh_is_ghost(m, h / 3))
            continue;
        a = m->xy[m->org[h]];
        b = m->xy[mesh_dest(m, h)];
        c = m->xy[m->org[mesh_prev(h)]];
        o[0] = orient2d(a, b, q);
        o[1] = orient2d(b, c, q);
        o[2] = orient2d(c, a, q);
        if (q.x == a.x && q.y == a.y)
            return (struct location){h, LOCATE_VERTEX};
        if (o[0] > 0 && o[1] > 0 && o[2] > 0)
            return (struct location){h, LOCATE_INSIDE};
        if (o[0] == 0 && o[1] > 0 && o[2] > 0)
            return (struct location){h, LOCATE_EDGE};
        if (mesh_is_ghost(m, m->twin[h] / 3) && o[0] < 0)
            at.he = h;
    }
    return at;
}

/* ---- volume by overlay */

struct corner {
    double x, y, g; /* g: of the clipping line; corners with g >= 0 are kept */
};

/* Clips the polygon p to the part where g >= 0 (Sutherland-Hodgman). */
static size_t clip(const struct corner *p, size_t n, struct corner *out)
{
    size_t k = 0;

    for (size_t i = 0; i < n; i++) {
        const struct corner *a = &p[i], *b = &p[(i + 1) % n];

        if (a->g >= 0)
            out[k++] = *a;
        if ((a->g > 0 && b->g < 0) || (a->g < 0 && b->g > 0)) {
            const double t = a->g / (a->g - b->g);

            out[k++] =
                (struct corner){a->x + t * (b->x - a->x), a->y + t * (b->y - a->y), 0};
        }
    }
    return k;
}

/* z = c[0] + c[1] x + c[2] y over the triangle t of m. */
static void plane(const struct mesh *m, uint32_t t, double c[3])
{
    const uint32_t *v = &m->org[3 * t];
    const double x0 = m->xy[v[0]].x, y0 = m->xy[v[0]].y, z0 = m->z[v[0]];
    const double x1 = m->xy[v[1]].x - x0, y1 = m->xy[v[1]].y - y0, z1 = m->z[v[1]] - z0;
    const double x2 = m->xy[v[2]].x - x0, y2 = m->xy[v[2]].y - y0, z2 = m->z[v[2]] - z0;
    const double det = x1 * y2 - x2 * y1;

    c[1] = (z1 * y2 - z2 * y1) / det;
    c[2] = (x1 * z2 - x2 * z1) / det;
    c[0] = z0 - c[1] * x0 - c[2] * y0;
}

/* The integral of g over the convex polygon p; *area: its area. */
static double integrate(const struct corner *p, size_t n, double *area)
{
    double sum = 0;

    *area = 0;
    for (size_t i = 2; i < n; i++) {
        const double a = 0.5 * ((p[i - 1].x - p[0].x) * (p[i].y - p[0].y) -
                                (p[i].x - p[0].x) * (p[i - 1].y - p[0].y));

        sum += a * (p[0].g + p[i - 1].g + p[i].g) / 3;
        *area += a;
    }
    return sum;
}

static double pair_volume(const struct mesh *a, uint32_t ta, const struct mesh *b,
                          uint32_t tb, double *area)
{
    struct corner poly[2][16];
    double pa[3], pb[3], up, down, part;
    size_t n = 3, k;
    int cur = 0;

    for (int i = 0; i < 3; i++) {
        const struct ivec2 v = a->xy[a->org[3 * ta + (uint32_t)i]];

        poly[0][i] = (struct corner){v.x, v.y, 0};
    }
    for (uint32_t h = 3 * tb; h < 3 * tb + 3; h++) {
        const struct ivec2 u = b->xy[b->org[h]], v = b->xy[mesh_dest(b, h)];

        for (size_t i = 0; i < n; i++)
            poly[cur][i].g = ((double)v.x - u.x) * (poly[cur][i].y - u.y) -
                             ((double)v.y - u.y) * (poly[cur][i].x - u.x);
        n = clip(poly[cur], n, poly[1 - cur]);
        cur = 1 - cur;
    }
    *area = 0;
    if (n < 3)
        return 0;
    plane(a, ta, pa);
    plane(b, tb, pb);
    for (size_t i = 0; i < n; i++)
        poly[cur][i].g = pb[0] - pa[0] + (pb[1] - pa[1]) * poly[cur][i].x +
                         (pb[2] - pa[2]) * poly[cur][i].y;
    k = clip(poly[cur], n, poly[1 - cur]);
    up = integrate(poly[1 - cur], k, &part);
    (void)integrate(poly[cur], n, area);
    for (size_t i = 0; i < n; i++)
        poly[cur][i].g = -poly[cur][i].g;
    k = clip(poly[cur], n, poly[1 - cur]);
    down = integrate(poly[1 - cur], k, &part);
    return up + down;
}

double brute_volume(const struct mesh *a, const struct mesh *b, double *area)
{
    double volume = 0, part;

    *area = 0;
    for (uint32_t ta = 0; ta < a->nt; ta++)
        for (uint32_t tb = 0; tb < b->nt; tb++) {
            if (mesh_is_ghost(a, ta) || mesh_is_ghost(b, tb))
                continue;
            volume += pair_volume(a, ta, b, tb, &part);
            *area += part;
        }
    return volume;
}
