#include "object.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "facegen.h"
#include "object_solid.h"
#include "draw.h"
#include "relief.h"
#include "solid.h"

/* ---- height fields */

static void make_saddle(const double *u, struct relief *f)
{
    f->saddle[0] = -20 - 30 * u[0];
    f->saddle[1] = 20 * u[1] - 10;
    f->saddle[2] = 15 + 30 * u[2];
}

static void make_cloth(const double *u, struct relief *f)
{
    f->waves = 7;
    for (int i = 0; i < 7; i++) {
        const double mm = 35 + 60 * u[i + 1], way = 3 * u[0] + 0.5 * u[i + 9];

        f->wave[i].kx = 6.28 / mm * cos(way);
        f->wave[i].ky = 6.28 / mm * sin(way);
        f->wave[i].phase = 6.28 * u[i + 2];
        f->wave[i].h = 0.08 * mm;
    }
}

static void make_ripples(const double *u, struct relief *f)
{
    f->waves = 2;
    for (int i = 0; i < 2; i++) {
        f->wave[i].kx = 6.28 / (30 + 40 * u[0]);
        f->wave[i].ky = (i == 0 ? 1 : -1) * f->wave[i].kx;
        f->wave[i].phase = 6.28 * u[1];
        f->wave[i].h = 4 + 6 * u[2];
    }
}

static void make_ridged_egg(const double *u, struct relief *f)
{
    f->depth = 35 + 30 * u[0];
    f->bumps = 1;
    f->bump[0] =
        (struct relief_bump){0, 30 * u[1], 6 + 6 * u[2], 15 + 25 * u[3], 12 + 14 * u[4]};
}

static void make_humped_egg(const double *u, struct relief *f)
{
    f->depth = 30 + 40 * u[0];
    f->bumps = 1;
    f->bump[0] = (struct relief_bump){10 * u[1] - 5, 20 * u[2] - 10, 9 + 9 * u[3],
                                      9 + 9 * u[4], 14 + 16 * u[5]};
}

static void make_bumpy_egg(const double *u, struct relief *f)
{
    f->depth = 25 + 40 * u[0];
    f->bumps = 10;
    for (int i = 0; i < 10; i++)
        f->bump[i] = (struct relief_bump){110 * u[i + 1] - 55, 150 * u[i + 6] - 75,
                                          7 + 12 * u[i + 3], 7 + 12 * u[i + 5],
                                          30 * u[i + 2] - 15};
}

static void make_step(const double *u, struct relief *f)
{
    /* a plane with a wide bump on one side: half of a step */
    f->saddle[1] = 10 * u[0];
    f->bumps = 2;
    f->bump[0] = (struct relief_bump){60, 0, 25 + 15 * u[1], 200, 20 + 30 * u[2]};
    f->bump[1] = (struct relief_bump){-70, 0, 15, 200, -20 * u[3]};
}

/* ---- what is left of a face, or made of it */

enum spoil {
    BAND_EYES,
    BAND_NOSE,
    BAND_MOUTH,
    BAND_UPRIGHT,
    HALF_SIZE,
    SMALLER,
    LARGER,
    TWICE,
    WIDE,
    TALL,
    HALF_DEEP,
    TWICE_DEEP,
    SHEARED,
    TWO_FACES,
    SIDES_SWAPPED
};

static bool kept(enum spoil how, const double *u, struct dvec3 p)
{
    const double half = 9 + 9 * u[1];

    switch (how) {
    case BAND_EYES:
        return fabs(p.y - 25 - 15 * u[0]) < half;
    case BAND_NOSE:
        return fabs(p.y - 10 * u[0]) < half;
    case BAND_MOUTH:
        return fabs(p.y + 30 + 15 * u[0]) < half;
    case BAND_UPRIGHT:
        return fabs(p.x - 60 * u[0] + 30) < half;
    default:
        return true;
    }
}

static struct dvec3 spoiled(enum spoil how, const double *u, struct dvec3 p)
{
    /* of what is too large or too small: by how much */
    const double more = how == TWICE     ? 2
                        : how == LARGER  ? 1.4
                        : how == SMALLER ? 0.7
                                         : 0.5;
    const double deep = how == TWICE_DEEP ? 1.9 + 0.5 * u[0] : 0.35 + 0.2 * u[0];
    const double stretch = 1.5 + 0.3 * u[0];

    switch (how) {
    case HALF_SIZE:
    case SMALLER:
    case LARGER:
    case TWICE:
        return (struct dvec3){more * p.x, more * p.y, more * p.z};
    case WIDE:
        return (struct dvec3){stretch * p.x, p.y, p.z};
    case TALL:
        return (struct dvec3){p.x, stretch * p.y, p.z};
    case HALF_DEEP:
    case TWICE_DEEP:
        return (struct dvec3){p.x, p.y, deep * p.z};
    case SHEARED:
        return (struct dvec3){p.x + (0.5 + 0.3 * u[0]) * p.y, p.y, p.z};
    case SIDES_SWAPPED: /* the left half on the right, and the other way round */
        return (struct dvec3){p.x < 0 ? p.x + 65 : p.x - 65, p.y, p.z};
    default:
        return p;
    }
}

static size_t scan_face(enum spoil how, const double *u, uint64_t seed, uint32_t points,
                        struct dvec3 *out)
{
    const size_t heads = how == TWO_FACES ? 2 : 1;
    struct facegen_scan s;
    size_t n = 0, left = 0;

    facegen_default(&s);
    for (size_t k = 0; k < heads; k++) {
        s.subject = 100000 + 10 * seed + k;
        s.points = points / (uint32_t)heads;
        facegen_pose(&s, 4, 5);
        s.tx += how == TWO_FACES ? (k == 0 ? -1 : 1) * (15 + 15 * u[0]) : 0;
        s.ty += how == TWO_FACES ? (k == 0 ? -1 : 1) * (10 + 20 * u[1]) : 0;
        n += facegen_sample(&s, out + n);
    }
    for (size_t i = 0; i < n; i++)
        if (kept(how, u, out[i]))
            out[left++] = spoiled(how, u, out[i]);
    return left;
}

/* ---- the list of kinds */

static const struct {
    const char *name;
    void (*relief)(const double *u, struct relief *f); /* or: */
    enum spoil spoil;
} kind[] = {
    {"saddle", make_saddle, 0},
    {"cloth in folds", make_cloth, 0},
    {"ripples", make_ripples, 0},
    {"egg with a ridge", make_ridged_egg, 0},
    {"egg with a hump", make_humped_egg, 0},
    {"egg with bumps", make_bumpy_egg, 0},
    {"step in a wall", make_step, 0},
    {"face: band of the eyes", NULL, BAND_EYES},
    {"face: band of the nose", NULL, BAND_NOSE},
    {"face: band of the mouth", NULL, BAND_MOUTH},
    {"face: upright band", NULL, BAND_UPRIGHT},
    {"face: half the size", NULL, HALF_SIZE},
    {"face: 0.7 times the size", NULL, SMALLER},
    {"face: 1.4 times the size", NULL, LARGER},
    {"face: twice the size", NULL, TWICE},
    {"face: 1.5 times as wide", NULL, WIDE},
    {"face: 1.5 times as tall", NULL, TALL},
    {"face: half as deep", NULL, HALF_DEEP},
    {"face: twice as deep", NULL, TWICE_DEEP},
    {"face: sheared", NULL, SHEARED},
    {"face: two in one", NULL, TWO_FACES},
    {"face: sides swapped", NULL, SIDES_SWAPPED},
};
#define KINDS (sizeof kind / sizeof kind[0])

uint32_t object_kinds(void)
{
    return object_solid_kinds() + KINDS;
}

const char *object_name(uint32_t k)
{
    const uint32_t solids = object_solid_kinds();

    return k < solids ? object_solid_name(k) : kind[k - solids].name;
}

static size_t scan_relief(uint32_t k, const double *u, uint32_t points, struct draw *r,
                          struct dvec3 *out)
{
    struct relief f = {.across = 60 + 25 * u[20], .power = 1 + 0.5 * u[21], .even = 1};

    f.up = f.across * (1 + 0.4 * u[22]);
    kind[k].relief(u, &f);
    return relief_sample(&f, points, 0.1 + 0.2 * u[23], r, out);
}

size_t object_scan(uint32_t k, uint64_t seed, uint32_t points, struct dvec3 *out)
{
    struct draw r = draw_stream(seed, k, 77);
    double u[OBJECT_SOLID_DRAWS];

    for (int i = 0; i < OBJECT_SOLID_DRAWS; i++)
        u[i] = draw_uniform(&r, 0, 1);
    if (k < object_solid_kinds())
        return object_solid_scan(k, u, points, &r, out);
    k -= object_solid_kinds();
    if (kind[k].relief != NULL)
        return scan_relief(k, u, points, &r, out);
    return scan_face(kind[k].spoil, u, seed, points, out);
}
