#include "object.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "draw.h"
#include "facegen.h"

#define DRAWS 24 /* numbers between 0 and 1 that an object is drawn from */

/* ---- solids of simple parts, by their signed distance */

#define SOLID_PARTS 48
#define SOLID_WAVES 48

enum solid_form {
    SOLID_BALL, /* an ellipsoid of half axes size */
    SOLID_CONE, /* about y: radius size[0] below, size[2] above, half height size[1] */
    SOLID_RING  /* about y: radius size[0], of a tube of radius size[1] */
};

struct solid_part {
    enum solid_form form;
    struct dvec3 at;
    double size[3];
    double turn[9]; /* row-major, the part's own axes -> the solid's */
    double blend;   /* mm over which it runs into the parts before */
    bool carved;    /* taken away from them */
};

struct solid {
    struct solid_part part[SOLID_PARTS];
    uint32_t n;
    struct {
        double k[3], phase, h;
    } wave[SOLID_WAVES]; /* relief of the whole surface: h cos(k . p + phase), mm */
    uint32_t waves;
};

struct solid_view {
    double turn[9];  /* the solid's axes -> the scanner's */
    double wide;     /* mm: half the side of the square that is seen */
    uint32_t points; /* at most */
    double noise;    /* along z, mm */
};

static double length3(double x, double y, double z)
{
    return sqrt(x * x + y * y + z * z);
}

/* Near the surface about the distance; of any point the right sign. */
static double ball(const double *a, struct dvec3 p)
{
    const double x = p.x / a[0], y = p.y / a[1], z = p.z / a[2];
    const double slope = length3(x / a[0], y / a[1], z / a[2]), k = length3(x, y, z);

    return slope > 0 ? k * (k - 1) / slope : -fmin(a[0], fmin(a[1], a[2]));
}

static double cone(const double *a, struct dvec3 p)
{
    const double q = hypot(p.x, p.z), slant = a[2] - a[0], high = 2 * a[1];
    const double end = p.y < 0 ? a[0] : a[2];
    const double ax = q - fmin(q, end), ay = fabs(p.y) - a[1];
    const double t =
        ((a[2] - q) * slant + (a[1] - p.y) * high) / (slant * slant + high * high);
    const double k = fmin(fmax(t, 0), 1);
    const double bx = q - a[2] + slant * k, by = p.y - a[1] + high * k;
    const double d = sqrt(fmin(ax * ax + ay * ay, bx * bx + by * by));

    return bx < 0 && ay < 0 ? -d : d;
}

static double part_distance(const struct solid_part *s, struct dvec3 p)
{
    const struct dvec3 d = vec_sub(p, s->at);
    const double *t = s->turn;
    const struct dvec3 q = {t[0] * d.x + t[3] * d.y + t[6] * d.z,
                            t[1] * d.x + t[4] * d.y + t[7] * d.z,
                            t[2] * d.x + t[5] * d.y + t[8] * d.z};

    switch (s->form) {
    case SOLID_BALL:
        return ball(s->size, q);
    case SOLID_CONE:
        return cone(s->size, q);
    default:
        return hypot(hypot(q.x, q.z) - s->size[0], q.y) - s->size[1];
    }
}

/* The lesser of the two, rounded off where they differ by less than k. */
static double blend(double a, double b, double k)
{
    const double h = k - fabs(a - b);

    return fmin(a, b) - (h > 0 ? h * h / (4 * k) : 0);
}

static double distance(const struct solid *s, struct dvec3 p)
{
    double d = 1e3;

    for (uint32_t i = 0; i < s->n; i++) {
        const double e = part_distance(&s->part[i], p);

        d = s->part[i].carved ? -blend(-d, e, s->part[i].blend)
                              : blend(d, e, s->part[i].blend);
    }
    for (uint32_t i = 0; i < s->waves && d < 30; i++)
        d -= s->wave[i].h * cos(s->wave[i].k[0] * p.x + s->wave[i].k[1] * p.y +
                                s->wave[i].k[2] * p.z + s->wave[i].phase);
    return d;
}

/* A further part, its axes as the solid's. */
static struct solid_part *solid_add(struct solid *s, enum solid_form form, double x,
                                    double y, double z, double a, double b, double c,
                                    double blend_mm)
{
    struct solid_part *p = &s->part[s->n++];

    *p = (struct solid_part){.form = form,
                             .at = {x, y, z},
                             .size = {a, b, c},
                             .turn = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                             .blend = fmax(blend_mm, 0.1)};
    return p;
}

/* Rz Rx Ry of these angles in degrees. */
static void solid_turn(double yaw, double pitch, double roll, double out[9])
{
    const double y = yaw / VEC_DEGREES, x = pitch / VEC_DEGREES, z = roll / VEC_DEGREES;
    const double cy = cos(y), sy = sin(y), cx = cos(x), sx = sin(x);
    const double m[3][3] = {
        {cy, 0, sy}, {sx * sy, cx, -sx * cy}, {-cx * sy, sx, cx * cy}};

    for (int i = 0; i < 3; i++) {
        out[i] = cos(z) * m[0][i] - sin(z) * m[1][i];
        out[3 + i] = sin(z) * m[0][i] + cos(z) * m[1][i];
        out[6 + i] = m[2][i];
    }
}

/* n waves of lengths between low and high mm and amplitudes slope times that. */
static void solid_roughen(struct solid *s, int n, double low, double high, double slope,
                          struct draw *r)
{
    for (int i = 0; i < n; i++) {
        const double mm = low * pow(high / low, draw_uniform(r, 0, 1));
        double k[3], sum = 0;

        for (int a = 0; a < 3; a++) {
            k[a] = draw_normal(r);
            sum += k[a] * k[a];
        }
        for (int a = 0; a < 3; a++)
            s->wave[s->waves].k[a] = k[a] / sqrt(sum) * 6.283185307179586 / mm;
        s->wave[s->waves].phase = draw_uniform(r, 0, 6.283185307179586);
        s->wave[s->waves++].h = slope * mm * draw_uniform(r, 0.5, 1);
    }
}

/* The points (room for v->points) that a scanner looking along -z sees, in random order; fewer
 * where little of the square is filled. */
static size_t solid_scan(const struct solid *s, const struct solid_view *v,
                         struct draw *r, struct dvec3 *out)
{
    const double far = 3 * v->wide, *t = v->turn;
    const struct dvec3 to = {t[6], t[7], t[8]}; /* the scanner, in the solid's axes */
    size_t n = 0;

    for (uint64_t tries = 0; n < v->points && tries < 12 * (uint64_t)v->points; tries++) {
        const double x = draw_uniform(r, -v->wide, v->wide);
        const double y = draw_uniform(r, -v->wide, v->wide);
        const struct dvec3 from = {t[0] * x + t[3] * y, t[1] * x + t[4] * y,
                                   t[2] * x + t[5] * y};
        double z = far, d = 1, slope;

        for (int i = 0; i < 160 && z > -far && fabs(d) > 0.02; i++) {
            d = distance(s, vec_along(from, z, to));
            z -= fmin(0.7 * d, 40);
        }
        if (fabs(d) > 0.2)
            continue;
        /* As seen from the scanner; what is steeper than 75 degrees it does not see. */
        slope = (distance(s, vec_along(from, z + 0.5, to)) -
                 distance(s, vec_along(from, z - 0.5, to)));
        if (slope < 0.25)
            continue;
        z += v->noise * draw_normal(r) * (1 + (1 - fmin(slope, 1)) * 2);
        out[n++] = (struct dvec3){x, y, z};
    }
    return n;
}

/* ---- the things made of them */

static void on_both_sides(struct solid *s, enum solid_form form, double x, double y,
                          double z, double a, double b, double c, double blend)
{
    (void)solid_add(s, form, -x, y, z, a, b, c, blend);
    (void)solid_add(s, form, x, y, z, a, b, c, blend);
}

static void tilt(struct solid *s, double yaw, double pitch, double roll)
{
    solid_turn(yaw, pitch, roll, s->part[s->n - 1].turn);
}

static void make_cone(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_CONE, 0, 0, 0, 50 + 40 * u[0], 60 + 40 * u[1], 30 * u[2], 0);
}

static void make_bottle(const double *u, struct solid *s, struct draw *r)
{
    const double a = 35 + 25 * u[0], neck = 12 + 6 * u[1];

    (void)r;
    solid_add(s, SOLID_CONE, 0, -40, 0, a, 60, a, 0);
    solid_add(s, SOLID_CONE, 0, 40, 0, a, 20 + 10 * u[2], neck, 8);
    solid_add(s, SOLID_CONE, 0, 75, 0, neck, 25, neck, 6);
    solid_add(s, SOLID_RING, 0, 97, 0, neck, 3, 0, 2);
}

static void make_teapot(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, 0, 0, 75, 55 + 15 * u[0], 75, 0);
    for (int i = 0; i < 4; i++) /* the spout, towards z */
        solid_add(s, SOLID_BALL, 0, -10 + 14 * i, 62 + 14 * i + 8 * u[1], 17 - 2.5 * i,
                  17 - 2.5 * i, 17 - 2.5 * i, 12);
    solid_add(s, SOLID_BALL, 0, 60 + 12 * u[0], 0, 12, 12, 12, 8);
    solid_add(s, SOLID_RING, 0, 5, -85, 30, 7, 0, 4);
    tilt(s, 0, 0, 90);
}

static void make_vase(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    for (int i = 0; i < 6; i++) {
        const double a = 25 + 45 * u[i];

        solid_add(s, SOLID_BALL, 0, 34 * i - 85, 0, a, 28, a, 14);
    }
}

static void make_cow(const double *u, struct solid *s, struct draw *r)
{
    const double m = 24 + 6 * u[0];

    (void)r;
    solid_add(s, SOLID_BALL, 0, 0, -150, 60, 60, 110, 0);
    solid_add(s, SOLID_BALL, 0, 30, -40, 32, 40, 45, 25);
    solid_add(s, SOLID_BALL, 0, 40, 0, 38, 42, 40, 20);
    solid_add(s, SOLID_BALL, 0, 12, 45, m, m, 45, 20); /* the muzzle */
    solid_add(s, SOLID_BALL, 0, 8, 80, m + 2, m - 4, 12, 8);
    on_both_sides(s, SOLID_BALL, 12, 14, 92, 5, 4, 6, 2);
    s->part[s->n - 1].carved = s->part[s->n - 2].carved = true;
    on_both_sides(s, SOLID_BALL, 33, 50, 22, 8, 8, 8, 4);    /* eyes */
    on_both_sides(s, SOLID_BALL, 52, 60, -10, 26, 10, 7, 5); /* ears */
    on_both_sides(s, SOLID_CONE, 28, 90, -5, 9, 25, 2, 5);   /* horns */
    for (int i = 0; i < 2; i++)
        on_both_sides(s, SOLID_CONE, 35, -80, -80 - 140 * i, 11, 50, 14, 10);
}

static void make_fist(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, -10, -30, 42, 38, 35, 0);
    for (int i = 0; i < 4; i++) {
        solid_add(s, SOLID_BALL, -30 + 20 * i, 12, 0, 10.5, 11, 22, 5);
        solid_add(s, SOLID_BALL, -30 + 20 * i, -8 + 4 * u[i], 8, 10, 17, 10, 5);
    }
    solid_add(s, SOLID_BALL, 0, -25, 18 + 6 * u[5], 30, 11, 11, 5);
    tilt(s, 0, 0, 20);
    solid_add(s, SOLID_CONE, 0, -75, -35, 28, 45, 26, 12);
}

static void make_foot(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, -30, -70, 30, 28, 35, 0);
    solid_add(s, SOLID_BALL, 0, -32, 20, 38, 22 + 6 * u[0], 75, 30);
    solid_add(s, SOLID_CONE, 0, 40, -65, 32, 75, 38, 30);
    for (int i = 0; i < 5; i++)
        solid_add(s, SOLID_BALL, -30 + 15 * i, -42, 85 - 5 * i, i == 0 ? 11 : 8, 9, 16,
                  4);
}

/* A head without a face: skull, ears, neck, hair. */
static void make_head(const double *u, struct solid *s, struct draw *r)
{
    solid_add(s, SOLID_BALL, 0, 20, 0, 72 + 5 * u[0], 95, 90 + 8 * u[1], 0);
    solid_add(s, SOLID_BALL, 0, -50, 25, 50, 50, 55, 30);
    solid_add(s, SOLID_CONE, 0, -120, -10, 65, 60, 52, 25);
    for (int side = -1; side <= 1; side += 2) {
        solid_add(s, SOLID_BALL, side * 76, 0, -8, 7, 32, 19, 4);
        tilt(s, side * 25, 0, 0);
        solid_add(s, SOLID_BALL, side * 86, 0, 0, 8, 20, 9, 3)->carved = true;
    }
    if (u[3] < 0.75) /* hair */
        solid_roughen(s, 20, 6, 40, 0.015 + 0.02 * u[2], r);
}

static size_t scan_solid(const struct solid *s, const struct solid_view *side,
                         const double *u, struct draw *r, struct dvec3 *out)
{
    const double zoom = 0.75 + 0.5 * u[20];
    const size_t n = solid_scan(s, side, r, out);

    for (size_t i = 0; i < n; i++)
        out[i] = (struct dvec3){zoom * out[i].x, zoom * out[i].y, zoom * out[i].z};
    return n;
}

/* ---- an egg with a ridge */

static double egg_height(const double *u, double x, double y)
{
    const double a = x / (60 + 25 * u[20]), b = y / (80 + 25 * u[20]);
    const double p = x / (6 + 6 * u[2]), q = (y - 30 * u[1]) / (15 + 25 * u[3]);

    return -(35 + 30 * u[0]) * pow(a * a + b * b, 1 + 0.5 * u[21]) +
           (12 + 14 * u[4]) * exp(-(p * p + q * q) / 2);
}

/* Uniform in x and y within its outline, without what is steeper than 75 degrees. */
static size_t scan_egg(const double *u, uint32_t points, struct draw *r,
                       struct dvec3 *out)
{
    const double across = 60 + 25 * u[20], up = across + 20;
    size_t n = 0;

    for (uint64_t tries = 0; n < points && tries < 12 * (uint64_t)points; tries++) {
        const double x = draw_uniform(r, -across, across), y = draw_uniform(r, -up, up);
        const double z = egg_height(u, x, y), dx = 2 * (egg_height(u, x + 0.5, y) - z);
        const double dy = 2 * (egg_height(u, x, y + 0.5) - z);

        if (hypot(x / across, y / up) <= 1 && dx * dx + dy * dy <= 15)
            out[n++] = (struct dvec3){x, y, z + 0.2 * draw_normal(r)};
    }
    return n;
}

/* ---- what is made of faces */

/* Two faces in one place, or one whose left half is on the right. */
static size_t scan_faces(size_t faces, const double *u, uint64_t seed, uint32_t points,
                         struct dvec3 *out)
{
    struct facegen_scan s;
    size_t n = 0;

    facegen_default(&s);
    for (size_t k = 0; k < faces; k++) {
        const double side = faces == 1 ? 0 : k == 0 ? -1 : 1;

        s.subject = 100000 + 10 * seed + k;
        s.points = points / (uint32_t)faces;
        facegen_pose(&s, 4, 5);
        s.tx += side * (15 + 15 * u[0]);
        s.ty += side * (10 + 20 * u[1]);
        n += facegen_sample(&s, out + n);
    }
    for (size_t i = 0; faces == 1 && i < n; i++)
        out[i].x += out[i].x < 0 ? 65 : -65;
    return n;
}

/* ---- the kinds, the solid ones with the sides that they are seen from */

static const struct {
    void (*make)(const double *u, struct solid *s, struct draw *r);
    double yaw, pitch, loose; /* degrees: the side, and turned at random within +-loose */
    double wide;              /* mm: half of what is seen at first */
} kind[] = {
    {make_cone, 0, 90, 30, 110},   {make_bottle, 0, 0, 25, 120},
    {make_teapot, 90, 0, 20, 130}, {make_vase, 0, 0, 20, 125},
    {make_fist, 0, 0, 25, 100},    {make_foot, 0, 15, 20, 120},
    {make_head, 180, 0, 25, 130},  {make_cow, 0, 0, 15, 120},
};
#define SOLIDS (sizeof kind / sizeof kind[0])

size_t object_scan(uint32_t k, uint64_t seed, uint32_t points, struct dvec3 *out)
{
    struct draw r = draw_stream(seed, k, 77);
    struct solid s = {0};
    struct solid_view v = {.points = points};
    double u[DRAWS];

    for (int i = 0; i < DRAWS; i++)
        u[i] = draw_uniform(&r, 0, 1);
    if (k == OBJECT_EGG)
        return scan_egg(u, points, &r, out);
    if (k >= SOLIDS)
        return scan_faces(k == OBJECT_TWO_FACES ? 2 : 1, u, seed, points, out);
    kind[k].make(u, &s, &r);
    v.wide = kind[k].wide;
    v.noise = 0.3 * u[19];
    solid_turn(kind[k].yaw + kind[k].loose * (2 * u[21] - 1),
               kind[k].pitch + kind[k].loose * (2 * u[22] - 1),
               kind[k].loose / 3 * (2 * u[23] - 1), v.turn);
    return scan_solid(&s, &v, u, &r, out);
}
