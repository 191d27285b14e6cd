#include "headcover.h"

#include <math.h>
#include <stdlib.h>

#include "draw.h"
#include "headview.h"
#include "vec.h"

/* Heights over the plane of the canonical frame, every STEP mm; NAN: nothing. */
#define STEP   2.0
#define NX     101
#define NY     121
#define LEFT   (-100.0)
#define BOTTOM (-140.0)

struct sheet {
    double z[NY][NX];
};

struct maker {
    struct head *h;
    struct draw r;
    struct sheet skin, on;
    bool within; /* nothing beyond the skin's outline */
};

static double x_of(int i)
{
    return LEFT + STEP * i;
}

static double y_of(int j)
{
    return BOTTOM + STEP * j;
}

/* 1 at 0, falls to 0 at 1 and stays there; smooth. */
static double bump(double t)
{
    return t < 1 ? vec_square(1 - t * t) : 0;
}

static double at_sheet(const struct sheet *s, double x, double y)
{
    const double u = (x - LEFT) / STEP, v = (y - BOTTOM) / STEP;
    const int i = (int)u, j = (int)v;
    double a, b;

    if (!(u >= 0 && v >= 0 && i + 1 < NX && j + 1 < NY))
        return (double)NAN;
    a = s->z[j][i] + (u - i) * (s->z[j][i + 1] - s->z[j][i]);
    b = s->z[j + 1][i] + (u - i) * (s->z[j + 1][i + 1] - s->z[j + 1][i]);
    return a + (v - j) * (b - a);
}

static void read_skin(struct maker *m, bool one_layer)
{
    struct headview v;

    headview_make(m->h, one_layer, &v);
    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++) {
            if (headview_at(&v, x_of(i), y_of(j), &m->skin.z[j][i]) == HEAD_VOID)
                m->skin.z[j][i] = (double)NAN;
            m->on.z[j][i] = (double)NAN;
        }
    headview_free(&v);
}

/* A smooth random height of the given root mean square: waves some `wide` mm long. */
static double waves(struct draw r, double rms, double wide, double x, double y)
{
    double sum = 0;

    for (int k = 0; k < 8; k++) {
        const double turn = draw_uniform(&r, 0, 3.1416);
        const double f = 6.2832 / (wide * draw_uniform(&r, 0.7, 1.5));

        sum += cos(f * (x * cos(turn) + y * sin(turn)) + draw_uniform(&r, 0, 6.2832));
    }
    return rms * sum / 2;
}

static bool on_skin(const struct maker *m, double x, double y)
{
    return !isnan(at_sheet(&m->skin, x, y));
}

static void headcover_put(struct maker *m, double x, double y, double z,
                          enum head_part part)
{
    if (!m->within || on_skin(m, x, y))
        head_add(m->h, (struct dvec3){x, y, z}, part);
}

/* The sheet m->on as points; lost: share of it that gives the scanner nothing, in blobs.
 * Where it ends, its edge goes down to the skin. */
static void put_sheet(struct maker *m, double lost)
{
    const struct draw blobs = {draw_next(&m->r)};
    /* The waves are nearly normal: of N(0, 1) the share `lost` is above limit. */
    const double limit = lost <= 0 ? INFINITY : 1.8 * (0.5 - lost) / 0.7;

    for (double y = BOTTOM; y < y_of(NY - 1); y += HEAD_COVER_MM)
        for (double x = LEFT; x < x_of(NX - 1); x += HEAD_COVER_MM) {
            const double px = x + draw_uniform(&m->r, -0.4, 0.4);
            const double py = y + draw_uniform(&m->r, -0.4, 0.4);
            const double z = at_sheet(&m->on, px, py);
            const double end = at_sheet(&m->on, px + 2 * (px > 0 ? 1 : -1), py);
            const double low = at_sheet(&m->skin, px, py);
            const bool none = lost > 0 && waves(blobs, 1, 22, px, py) > limit;

            if (isnan(z))
                continue;
            headcover_put(m, px, py, z, none ? HEAD_VOID : HEAD_COVER);
            for (double edge = z - 1.2; isnan(end) && edge > low; edge -= 1.2)
                headcover_put(m, px, py, edge, HEAD_COVER);
        }
}

/* The upper hull of the heights along one line of the sheet, and of the skin on which the line
 * begins and ends: cloth does not sag. */
static void tighten(struct maker *m, int i, int j, int di, int dj, double gap)
{
    double t[NX + NY], z[NX + NY];
    int hull[NX + NY], n = 0, k = 0;

    for (int s = -1; i + s * di >= 0 && i + s * di < NX && j + s * dj < NY; s++) {
        const double on = m->on.z[j + s * dj][i + s * di];

        t[n] = s;
        z[n++] = isnan(on) ? m->skin.z[j + s * dj][i + s * di] + gap : on;
        if (isnan(on) && s >= 0)
            break;
    }
    for (int p = 0; p < n; p++) {
        if (isnan(z[p]))
            continue;
        while (k > 1 && (z[hull[k - 1]] - z[hull[k - 2]]) * (t[p] - t[hull[k - 2]]) <=
                            (z[p] - z[hull[k - 2]]) * (t[hull[k - 1]] - t[hull[k - 2]]))
            k--;
        hull[k++] = p;
    }
    for (int q = 0; q + 1 < k; q++)
        for (int p = hull[q] + 1; p < hull[q + 1]; p++)
            if (!isnan(m->on.z[j + (p - 1) * dj][i + (p - 1) * di]))
                m->on.z[j + (p - 1) * dj][i + (p - 1) * di] =
                    z[hull[q]] + (z[hull[q + 1]] - z[hull[q]]) * (p - hull[q]) /
                                     (hull[q + 1] - hull[q]);
}

/* A cloth over the skin where m->on is not NAN, which must be the least height that it may
 * have there: taut between its edges, which lie `gap` above the skin, and straight from each
 * point that holds it up to the next; folds aside, cloth bends in one direction at a time. */
static void drape(struct maker *m, double gap)
{
    static const int direction[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};

    for (int k = 0; k < 8; k++) {
        const int di = direction[k % 4][0], dj = direction[k % 4][1];

        for (int j = 1; j + 1 < NY; j++)
            for (int i = 1; i + 1 < NX; i++)
                if (!isnan(m->on.z[j][i]) && isnan(m->on.z[j - dj][i - di]))
                    tighten(m, i, j, di, dj, gap);
    }
}

/* The least height: `gap` above the skin; where there is none, as near as there is some. */
static double least_height(const struct maker *m, double x, double y, double gap)
{
    double z = at_sheet(&m->skin, x, y);

    for (double k = 0.98; isnan(z) && k > 0.5; k -= 0.02)
        z = at_sheet(&m->skin, x * k, y * k) - 60 * (1 - k);
    return z + gap;
}

/* ---- glasses */

struct frame_shape {
    double x, y, a, b, power; /* of a lens: centre, half axes, how rectangular */
    double rim, z, tilt, wrap;
};

static double lens_radius(const struct frame_shape *g, double x, double y)
{
    return pow(pow(fabs((fabs(x) - g->x) / g->a), g->power) +
                   pow(fabs((y - g->y) / g->b), g->power),
               1 / g->power);
}

static double lens_height(const struct frame_shape *g, double x, double y)
{
    return g->z + g->tilt * (y - g->y) - g->wrap * fabs(x) -
           vec_square(fabs(x) - g->x) / 190 - vec_square(y - g->y) / 190;
}

static void shape_glasses(struct maker *m, struct frame_shape *g)
{
    struct draw *r = &m->r;
    double z = -1e3;

    *g = (struct frame_shape){.x = draw_uniform(r, 31, 35),
                              .y = draw_uniform(r, 24, 30),
                              .a = draw_uniform(r, 22, 27),
                              .b = draw_uniform(r, 14, 23),
                              .power = draw_uniform(r, 2, 5),
                              .rim = draw_uniform(r, 2, 5),
                              .tilt = draw_uniform(r, 0.05, 0.2),
                              .wrap = draw_uniform(r, 0, 0.08)};
    if (draw_uniform(r, 0, 1) < 0.15)
        g->rim = 0.6; /* rimless */
    /* The rim rests on the bridge of the nose, and the lens touches neither brow nor cheek. */
    for (double y = g->y - g->b; y <= g->y + g->b; y += STEP)
        for (double x = g->x - g->a; x <= g->x + g->a; x += STEP)
            if (lens_radius(g, x, y) < 1)
                for (int side = -1; side <= 1; side += 2) {
                    const double s = at_sheet(&m->skin, side * x, y);

                    if (s - lens_height(g, x, y) > z)
                        z = s - lens_height(g, x, y);
                }
    g->z = z + draw_uniform(r, 1, 4);
}

/* The temples: from the lens's outer end back to the ear. */
static void put_temples(struct maker *m, const struct frame_shape *g)
{
    const double x0 = g->x + g->a + g->rim, y = g->y + 5;
    const double z0 = lens_height(g, x0, y), high = draw_uniform(&m->r, 1.5, 5);

    for (int side = -1; side <= 1; side += 2)
        for (double back = 0; back < 95; back += HEAD_COVER_MM)
            for (double up = -high; up <= high; up += HEAD_COVER_MM)
                headcover_put(m, side * (x0 + back * (72 - x0) / 95), y + up, z0 - back,
                              HEAD_COVER);
}

/* What comes back from a lens: nothing; its own surface; or a few points of neither. */
static void put_glasses(struct maker *m)
{
    struct frame_shape g;
    double share, noise;

    shape_glasses(m, &g);
    share = draw_uniform(&m->r, 0, 1);
    noise = share < 0.45 ? 1.5 : share < 0.8 ? 0.2 : 4;
    share = share < 0.45  ? draw_uniform(&m->r, 0, 0.05)
            : share < 0.8 ? 1
                          : draw_uniform(&m->r, 0.1, 0.6);
    for (double y = g.y - g.b - 8; y < g.y + g.b + 8; y += HEAD_COVER_MM)
        for (double x = -g.x - g.a - 8; x < g.x + g.a + 8; x += HEAD_COVER_MM) {
            const double px = x + draw_uniform(&m->r, -0.4, 0.4);
            const double py = y + draw_uniform(&m->r, -0.4, 0.4);
            const double off = (lens_radius(&g, px, py) - 1) * fmin(g.a, g.b);
            const double z = lens_height(&g, px, py);
            const bool bridge = fabs(px) < g.x - g.a + 2 && py > g.y + 0.25 * g.b &&
                                py < g.y + 0.25 * g.b + g.rim + 1.5;

            if (bridge || (off >= 0 && off < g.rim))
                headcover_put(m, px, py, z + draw_uniform(&m->r, 0, 1.5), HEAD_COVER);
            else if (off < 0 && draw_uniform(&m->r, 0, 1) < share)
                headcover_put(m, px, py, z + noise * draw_normal(&m->r), HEAD_COVER);
            else if (off < 0)
                headcover_put(m, px, py, z, HEAD_VOID);
        }
    put_temples(m, &g);
}

/* ---- cloth */

static void put_mask(struct maker *m)
{
    struct draw *r = &m->r;
    const double top = draw_uniform(r, 0, 1) < 0.08 ? -14 : draw_uniform(r, 8, 24);
    const double drop = draw_uniform(r, 14, 26), wide = draw_uniform(r, 50, 64);
    const double bottom = draw_uniform(r, -84, -66), gap = draw_uniform(r, 1, 3);
    const double ridge = draw_uniform(r, 0, 1) < 0.35 ? draw_uniform(r, 6, 18) : 0;
    const double pleat = ridge > 0 ? 0 : draw_uniform(r, 0.2, 1.2);
    const double period = draw_uniform(r, 11, 18);
    const struct draw folds = {draw_next(r)};

    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++) {
            const double x = x_of(i), y = y_of(j), u = fabs(x) / wide;
            const double cone = ridge * bump(hypot(x / 45, (y + 22) / 45));

            if (u < 1 - 0.25 * vec_square((y + 30) / 60) &&
                y < top - drop * pow(u, 1.4) && y > bottom + 16 * u * u)
                m->on.z[j][i] = least_height(m, x, y, gap + cone);
        }
    drape(m, 0.6);
    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++)
            m->on.z[j][i] += pleat * sin(6.2832 * y_of(j) / period) *
                                 bump(hypot(x_of(i) / 55, (y_of(j) + 30) / 32)) +
                             fabs(waves(folds, 0.4, 25, x_of(i), y_of(j)));
    put_sheet(m, 0);
}

static void put_scarf(struct maker *m)
{
    struct draw *r = &m->r;
    const double top = draw_uniform(r, -52, -16), gap = draw_uniform(r, 4, 10);
    const double fold = draw_uniform(r, 1, 2.5), period = draw_uniform(r, 16, 30);
    const double lean = draw_uniform(r, -0.4, 0.4), phase = draw_uniform(r, 0, 6.28);
    const struct draw edge = {draw_next(r)}, rough = {draw_next(r)};

    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++)
            if (y_of(j) <
                    top + waves(edge, 2, 50, x_of(i), 0) + vec_square(x_of(i)) / 500 &&
                fabs(x_of(i)) < 85)
                m->on.z[j][i] = least_height(m, x_of(i), y_of(j), gap);
    drape(m, gap);
    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++)
            m->on.z[j][i] +=
                fold * sin(6.2832 * (y_of(j) + lean * x_of(i)) / period + phase) +
                fabs(waves(rough, 0.8, 14, x_of(i), y_of(j)));
    put_sheet(m, 0);
}

/* ---- a hand */

struct bone {
    double x, y, dx, dy, length, radius, flat; /* flat: 1 round, 0 a sheet */
};

/* A finger or the palm laid on the skin: a capsule whose axis follows the cloth that would
 * lie over it. */
static void lay_bone(struct maker *m, const struct bone *b)
{
    double axis = -90; /* where there is no skin */

    for (int pass = 0; pass < 2; pass++)
        for (int j = 0; j < NY; j++)
            for (int i = 0; i < NX; i++) {
                const double x = x_of(i) - b->x, y = y_of(j) - b->y;
                const double along = fmin(fmax(x * b->dx + y * b->dy, 0), b->length);
                const double off = hypot(x - along * b->dx, y - along * b->dy);
                double z;

                if (off >= b->radius)
                    continue;
                if (pass == 0 && off < 2.5) {
                    z = m->skin.z[j][i];
                    axis = fmax(axis, isnan(z) ? -90 : z);
                } else if (pass == 1) {
                    /* as the skin falls away at the side, so do the fingers, but less */
                    z = fmax(least_height(m, x_of(i), y_of(j), 0), axis - 25);
                    z = 0.5 * (z + axis) +
                        b->flat * (0.5 * b->radius +
                                   sqrt(vec_square(b->radius) - vec_square(off)));
                    m->on.z[j][i] = isnan(m->on.z[j][i]) ? z : fmax(m->on.z[j][i], z);
                }
            }
}

static void put_hand(struct maker *m)
{
    struct draw *r = &m->r;
    const double side = draw_uniform(r, 0, 1) < 0.5 ? -1 : 1;
    const double x = side * draw_uniform(r, 38, 56), y = draw_uniform(r, -72, -50);
    const double turn = side * draw_uniform(r, -0.5, 0.25); /* radians from upright */
    const double fan = draw_uniform(r, 0.04, 0.14), finger = draw_uniform(r, 7, 9);
    const double dx = sin(turn), dy = cos(turn);

    for (int k = 0; k < 4; k++) {
        const double a = turn + fan * (k - 1.5), off = (k - 1.5) * 2.1 * finger;

        lay_bone(m, &(struct bone){x + 25 * dx + off * dy, y + 25 * dy - off * dx, sin(a),
                                   cos(a), draw_uniform(r, 58, 74) - 5 * (k == 3), finger,
                                   1});
    }
    lay_bone(m, &(struct bone){x, y, dx, dy, 30, 36, 0.45});
    lay_bone(m, &(struct bone){x - 70 * dx, y - 70 * dy, dx, dy, 60, 27, 0.8});
    put_sheet(m, 0);
}

/* ---- hair */

static void put_fringe(struct maker *m)
{
    struct draw *r = &m->r;
    const double low = draw_uniform(r, 36, 60), lean = draw_uniform(r, -0.3, 0.3);
    const double deep = draw_uniform(r, 2, 8), strand = draw_uniform(r, 4, 9);
    const double lost = draw_uniform(r, 0.1, 0.6);
    const struct draw edge = {draw_next(r)}, rough = {draw_next(r)};

    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++) {
            const double x = x_of(i), y = y_of(j);

            if (on_skin(m, 0.97 * x, y) &&
                y > low + lean * x - vec_square(x) / 300 + waves(edge, 3, 9, x, 0))
                m->on.z[j][i] = least_height(m, x, y, deep) +
                                waves(rough, 1, strand, x + 0.2 * y, 0.1 * y);
        }
    put_sheet(m, lost);
}

static void put_beard(struct maker *m)
{
    struct draw *r = &m->r;
    const double deep = draw_uniform(r, 1.5, 10), top = draw_uniform(r, -20, -5);
    const double lost = draw_uniform(r, 0, 0.3);
    const struct draw rough = {draw_next(r)}, clumps = {draw_next(r)};

    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++) {
            const double x = x_of(i), y = y_of(j), u = fabs(x) / 62;
            const bool lips = vec_square(x / 24) + vec_square((y + 29) / 8) < 1;
            /* the moustache, and whiskers up to the ears */
            const double upper =
                fabs(x) < 30 ? -15 - 0.1 * fabs(x) : top + 18 * (u - 0.5);

            if (!lips && y < upper && u < 1.1 && !(fabs(x) >= 30 && u < 0.62 && y > -38))
                m->on.z[j][i] =
                    least_height(m, x, y, 0.8) +
                    deep * bump(hypot(x / 75, fmin(y + 70, 0) / 80)) *
                        (y < -45 ? 1 : 0.4) +
                    fabs(waves(rough, 0.7, 6, x, y) + waves(clumps, 1, 18, x, y));
        }
    put_sheet(m, lost);
}

static void put_cap(struct maker *m)
{
    struct draw *r = &m->r;
    const double low = draw_uniform(r, 48, 62), out = draw_uniform(r, 45, 70);
    const double down = draw_uniform(r, 0, 0.35), thick = draw_uniform(r, 5, 9);
    const size_t skin = m->h->n;

    for (size_t i = 0; i < skin && !m->within; i++) { /* over the skull, all round */
        const struct dvec3 p = m->h->at[i];
        const struct dvec3 c = {p.x, p.y - 25, p.z + 105};

        if (m->h->part[i] == HEAD_SKIN && p.y > low + 0.15 * (p.z + 30))
            headcover_put(m, p.x + thick * c.x / sqrt(vec_dot(c, c)),
                          p.y + thick * c.y / sqrt(vec_dot(c, c)),
                          p.z + thick * c.z / sqrt(vec_dot(c, c)), HEAD_COVER);
    }
    for (int j = 0; j < NY; j++)
        for (int i = 0; i < NX; i++)
            if (y_of(j) > low)
                m->on.z[j][i] = m->skin.z[j][i] + thick;
    put_sheet(m, 0);
    for (double t = 0; t < 1; t += HEAD_COVER_MM / out)
        for (double x = -68; x <= 68; x += HEAD_COVER_MM) {
            const double root = least_height(m, x, low + 1, thick);
            const double reach = out * sqrt(1 - vec_square(x / 69));

            headcover_put(m, x, low + 1 - down * t * reach - 6 * vec_square(x / 69),
                          root + t * reach, HEAD_COVER);
        }
}

void headcover_add(struct head *h, enum headcover kind, uint64_t seed, bool one_layer)
{
    static void (*const put_kind[HEADCOVERS])(struct maker *) = {
        [HEADCOVER_GLASSES] = put_glasses, [HEADCOVER_MASK] = put_mask,
        [HEADCOVER_SCARF] = put_scarf,     [HEADCOVER_HAND] = put_hand,
        [HEADCOVER_FRINGE] = put_fringe,   [HEADCOVER_BEARD] = put_beard,
        [HEADCOVER_CAP] = put_cap};
    struct maker *m;

    if (put_kind[kind] == NULL)
        return;
    m = head_alloc(1, sizeof *m);
    m->h = h;
    m->r = draw_stream(seed, kind, 3);
    m->within = one_layer;
    read_skin(m, one_layer);
    put_kind[kind](m);
    free(m);
}
