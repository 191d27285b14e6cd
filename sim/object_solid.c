#include "object_solid.h"

#include <math.h>

#include "solid.h"

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

/* ---- bodies of geometry */

static void make_cone(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_CONE, 0, 0, 0, 50 + 40 * u[0], 60 + 40 * u[1], 30 * u[2], 0);
}

static void make_cylinder(const double *u, struct solid *s, struct draw *r)
{
    const double a = 40 + 50 * u[0];

    (void)r;
    solid_add(s, SOLID_CONE, 0, 0, 0, a, 70 + 40 * u[1], a, 0);
}

static void make_box(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BOX, 0, 0, 0, 40 + 40 * u[0], 50 + 50 * u[1], 40 + 40 * u[2], 0);
}

static void make_ball(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, 0, 0, 60 + 25 * u[0], 60 + 45 * u[1], 50 + 50 * u[2], 0);
}

static void make_ring(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_RING, 0, 0, 0, 45 + 30 * u[0], 15 + 20 * u[1], 0, 0);
}

/* ---- household */

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

static void make_mug(const double *u, struct solid *s, struct draw *r)
{
    const double a = 40 + 20 * u[0];

    (void)r;
    solid_add(s, SOLID_CONE, 0, 0, 0, a * (0.8 + 0.2 * u[1]), 60, a, 0);
    solid_add(s, SOLID_CONE, 0, 8, 0, a - 6, 60, a - 6, 0)->carved = true;
    solid_add(s, SOLID_RING, 0, 0, a, 30 + 8 * u[2], 7 + 3 * u[3], 0, 4);
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

static void make_bulb(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, 0, 0, 60 + 15 * u[0], 60 + 15 * u[0], 60, 0);
    solid_add(s, SOLID_CONE, 0, -70, 0, 25, 35, 35, 15);
    for (int i = 0; i < 4; i++)
        solid_add(s, SOLID_RING, 0, -78 - 8 * i, 0, 24, 4, 0, 2);
}

static void make_shoe(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, -20, 60, 40, 25 + 8 * u[0], 60, 0);
    solid_add(s, SOLID_BALL, 0, -5, -30, 36, 40, 55, 25);
    solid_add(s, SOLID_CONE, 0, 40, -50, 34, 35 + 25 * u[1], 38, 12);
    solid_add(s, SOLID_BOX, 0, -48, 15, 42, 5, 100, 3);
    for (int i = 0; i < 4; i++)
        solid_add(s, SOLID_BOX, 0, 10 + 6 * i, 38 - 17 * i, 22, 4, 3, 2);
}

static void make_chair(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BOX, 0, 0, 0, 60, 8, 60, 2);
    solid_add(s, SOLID_BOX, 0, 60, -55, 60, 60 + 15 * u[0], 6, 2);
    on_both_sides(s, SOLID_CONE, 50, -50, 50, 6, 50, 6, 1);
    on_both_sides(s, SOLID_CONE, 50, -50, -50, 6, 50, 6, 1);
    on_both_sides(s, SOLID_BOX, 62, 30, 0, 6, 6, 50, 1);
}

static void make_pumpkin(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    for (int i = 0; i < 11; i++) {
        const double way = 0.571 * i + u[0];

        solid_add(s, SOLID_BALL, 38 * sin(way), 0, 38 * cos(way), 42, 55 + 15 * u[1], 42,
                  6 + 6 * u[2]);
    }
    solid_add(s, SOLID_CONE, 0, 65, 0, 12, 18, 8, 6);
}

/* ---- machines */

static void make_machine(const double *u, struct solid *s, struct draw *r)
{
    solid_add(s, SOLID_BOX, 0, -30, 0, 75, 25, 45, 1);
    solid_add(s, SOLID_CONE, 0, 20, 20, 30 + 15 * u[0], 45, 30 + 15 * u[0], 2);
    tilt(s, 0, 90 * (u[1] < 0.5), 0);
    for (int i = 0; i < 7; i++) {
        const double x = draw_uniform(r, -65, 65), y = draw_uniform(r, -60, 60);
        const double a = draw_uniform(r, 6, 18);

        solid_add(s, i % 2 ? SOLID_CONE : SOLID_BOX, x, y, 35, a, a, a, 1);
        tilt(s, 0, 90, 0);
    }
    solid_add(s, SOLID_CONE, 0, 20, 20, 14, 60, 14, 1)->carved = true;
    tilt(s, 0, 90, 0);
}

static void make_car(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BOX, 0, 0, 0, 55, 22, 120, 8);
    solid_add(s, SOLID_BALL, 0, 30, -15, 52, 30 + 10 * u[0], 75, 14);
    on_both_sides(s, SOLID_BALL, 38, 6, 118, 12, 8, 8, 2); /* lamps */
    solid_add(s, SOLID_BOX, 0, -6, 122, 25, 8 + 4 * u[1], 5, 2);
    for (int i = 0; i < 2; i++) {
        on_both_sides(s, SOLID_CONE, 52, -22, 75 - 150 * i, 22, 9, 22, 1);
        tilt(s, 0, 0, 90);
        solid_turn(0, 0, 90, s->part[s->n - 2].turn);
    }
}

static void make_wall(const double *u, struct solid *s, struct draw *r)
{
    solid_add(s, SOLID_BOX, 0, 0, -60, 300, 300, 50, 0);
    solid_roughen(s, 12, 8, 60, 0.006 + 0.02 * u[0], r);
}

static void make_corner(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BOX, 0, 0, -130, 400, 400, 50 + 50 * u[0], 0);
    solid_add(s, SOLID_BOX, -130, 0, 0, 60, 400, 400, 0);
    solid_add(s, SOLID_BOX, 0, -130, 0, 400, 60, 400, 0);
}

static void make_edge(const double *u, struct solid *s, struct draw *r)
{
    make_box(u, s, r);
    solid_turn(35 + 20 * u[3], 35 + 20 * u[4], 0, s->part[0].turn);
}

static void make_rock(const double *u, struct solid *s, struct draw *r)
{
    solid_add(s, SOLID_BALL, 0, 0, 0, 60 + 20 * u[0], 65 + 35 * u[1], 60, 0);
    solid_roughen(s, 24, 25, 120, 0.03 + 0.03 * u[2], r);
    solid_roughen(s, 16, 6, 25, 0.02, r);
}

/* ---- living beings */

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

static void make_dog(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, 10, 0, 58, 60, 55, 0);
    solid_add(s, SOLID_BALL, 0, -12, 55, 24 + 6 * u[0], 22, 30 + 25 * u[1], 14);
    solid_add(s, SOLID_BALL, 0, -2, 88 + 25 * u[1], 11, 8, 8, 3);
    on_both_sides(s, SOLID_BALL, 24, 25, 46, 9, 9, 9, 3);
    on_both_sides(s, SOLID_BALL, 55, 40, -10, 14, 45, 22, 8);
    solid_add(s, SOLID_CONE, 0, -60, -35, 45, 45, 40, 20);
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

static void make_hand(const double *u, struct solid *s, struct draw *r)
{
    (void)r;
    solid_add(s, SOLID_BALL, 0, -35, 0, 44, 50, 16, 0);
    for (int i = 0; i < 4; i++) {
        const double long_mm = 38 + 8 * (i == 1 || i == 2);

        solid_add(s, SOLID_BALL, -32 + 21 * i, 20 + long_mm, 4 * u[i], 9.5, long_mm, 9.5,
                  6);
        tilt(s, 0, -15 * u[4], 6 * (1.5 - i) * u[5]);
    }
    solid_add(s, SOLID_BALL, 52, -20, 12, 11, 36, 11, 10);
    tilt(s, 0, 0, -40);
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

static void make_snowman(const double *u, struct solid *s, struct draw *r)
{
    const double a = 8 + 5 * u[0], b = 22 + 12 * u[1];

    (void)r;
    solid_add(s, SOLID_BALL, 0, 0, 0, 75, 75 + 10 * u[2], 75, 0);
    solid_add(s, SOLID_CONE, 0, -5, 72 + b, a, b, 2, 3); /* a carrot */
    tilt(s, 0, 90, 0);
    solid_add(s, SOLID_BALL, 0, -140, -10, 100, 95, 95, 5);
}

/* Metaballs at random. */
static void make_blobs(const double *u, struct solid *s, struct draw *r)
{
    for (int i = 0; i < 9; i++) {
        const double x = draw_uniform(r, -45, 45), y = draw_uniform(r, -65, 65);
        const double z = draw_uniform(r, -30, 30), a = draw_uniform(r, 18, 50);

        solid_add(s, SOLID_BALL, x, y, z, a, a * (0.7 + 0.6 * u[i]), a, 25);
    }
}

/* ---- the list of kinds, and the sides that they are seen from */

static const struct {
    const char *name;
    void (*make)(const double *u, struct solid *s, struct draw *r);
    double yaw, pitch, loose; /* degrees: the side, and turned at random within +-loose */
    double wide;              /* mm: half of what is seen at first */
} kind[] = {
    {"cone from the side", make_cone, 0, 0, 25, 110},
    {"cone from its point", make_cone, 0, 90, 30, 110},
    {"cylinder", make_cylinder, 0, 0, 40, 110},
    {"box", make_box, 0, 0, 30, 110},
    {"corner of a box", make_edge, 0, 0, 10, 110},
    {"ball", make_ball, 0, 0, 45, 110},
    {"ring", make_ring, 0, 50, 40, 110},
    {"bottle", make_bottle, 0, 0, 25, 120},
    {"teapot with its spout in front", make_teapot, 0, 0, 15, 120},
    {"teapot from the side", make_teapot, 90, 0, 20, 130},
    {"mug with its handle in front", make_mug, 0, 0, 20, 100},
    {"vase", make_vase, 0, 0, 20, 125},
    {"light bulb", make_bulb, 0, 0, 45, 115},
    {"shoe", make_shoe, 0, 20, 40, 130},
    {"chair", make_chair, 20, 20, 20, 120},
    {"pumpkin", make_pumpkin, 0, 0, 30, 110},
    {"machine part", make_machine, 0, 0, 25, 110},
    {"car from the front", make_car, 0, 0, 20, 120},
    {"car from the side", make_car, 90, 0, 15, 130},
    {"wall", make_wall, 0, 0, 20, 100},
    {"corner of a room", make_corner, 25, -25, 12, 120},
    {"rock", make_rock, 0, 0, 90, 110},
    {"cow from the front", make_cow, 0, 0, 15, 120},
    {"cow from the left", make_cow, 70, 0, 20, 140},
    {"cow from the right", make_cow, -70, 0, 20, 140},
    {"dog", make_dog, 0, 0, 20, 120},
    {"fist", make_fist, 0, 0, 25, 100},
    {"open hand", make_hand, 0, 0, 25, 110},
    {"foot from the front", make_foot, 0, 15, 20, 120},
    {"foot from the side", make_foot, 80, 0, 20, 130},
    {"back of a head", make_head, 180, 0, 25, 130},
    {"top of a head", make_head, 0, 90, 20, 120},
    {"side of a head", make_head, 90, 0, 15, 130},
    {"egg with ears and a neck", make_head, 0, 0, 15, 130},
    {"snowman's head", make_snowman, 0, 0, 10, 110},
    {"blobs", make_blobs, 0, 0, 90, 110},
};
#define KINDS (sizeof kind / sizeof kind[0])

uint32_t object_solid_kinds(void)
{
    return KINDS;
}

const char *object_solid_name(uint32_t k)
{
    return kind[k].name;
}

size_t object_solid_scan(uint32_t k, const double u[OBJECT_SOLID_DRAWS], uint32_t points,
                         struct draw *r, struct dvec3 *out)
{
    const double loose = kind[k].loose, zoom = 0.75 + 0.5 * u[20];
    struct solid_view v = {.wide = kind[k].wide, .points = points, .noise = 0.3 * u[19]};
    struct solid s = {0};
    size_t n;

    kind[k].make(u, &s, r);
    solid_turn(kind[k].yaw + loose * (2 * u[21] - 1),
               kind[k].pitch + loose * (2 * u[22] - 1), loose / 3 * (2 * u[23] - 1),
               v.turn);
    n = solid_scan(&s, &v, r, out);
    for (size_t i = 0; i < n; i++)
        out[i] = (struct dvec3){zoom * out[i].x, zoom * out[i].y, zoom * out[i].z};
    return n;
}
