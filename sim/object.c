#include "object.h"

#include <math.h>

#include "draw.h"
#include "facegen.h"
#include "solid.h"

#define DRAWS 24 /* numbers between 0 and 1 that an object is drawn from */

/* ---- solids */

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
