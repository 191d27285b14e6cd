/* removal.c -- which removals hurt, and what leaving out bridging triangles gains: points at
 * random, in blobs, on the ridges, at the hull, taken from dense random samples of the six
 * test functions. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brute.h"
#include "holes.h"
#include "lab.h"
#include "study.h"

#define POINTS 1000
#define GRID   101
#define SHARES 6

enum kind { RANDOM, BLOBS, RIDGES, FLATS, HULL, KINDS };
static const char *const kind_name[KINDS] = {"random", "blobs", "ridges", "flats",
                                             "hull"};
static const int percent[SHARES] = {0, 15, 30, 45, 60, 75};

struct ranked {
    double rank; /* the smallest goes first */
    double x, y;
};

static int by_rank(const void *a, const void *b)
{
    const double x = ((const struct ranked *)a)->rank,
                 y = ((const struct ranked *)b)->rank;

    return (x > y) - (x < y);
}

/* How strongly the function bends at a place: its Hessian's size. */
static double bend(unsigned f, double x, double y)
{
    const double h = 0.01, z = lab_function(f, x, y);
    const double xx = lab_function(f, x + h, y) - 2 * z + lab_function(f, x - h, y);
    const double yy = lab_function(f, x, y + h) - 2 * z + lab_function(f, x, y - h);
    const double xy = (lab_function(f, x + h, y + h) - lab_function(f, x + h, y - h) -
                       lab_function(f, x - h, y + h) + lab_function(f, x - h, y - h)) /
                      4;

    return sqrt(xx * xx + yy * yy + 2 * xy * xy);
}

/* The order in which a kind removes the points: blobs round eight random places that grow
 * together, the others by the place itself. */
static void rank(enum kind kind, unsigned f, struct ranked *p, struct brute_rng *r)
{
    double cx[8], cy[8];

    for (int i = 0; i < 8; i++) {
        cx[i] = brute_real(r);
        cy[i] = brute_real(r);
    }
    for (int i = 0; i < POINTS; i++) {
        const double x = p[i].x, y = p[i].y;
        double near = INFINITY;

        for (int k = 0; k < 8; k++)
            near = fmin(near, hypot(x - cx[k], y - cy[k]));
        switch (kind) {
        case BLOBS:
            p[i].rank = near;
            break;
        case RIDGES:
            p[i].rank = -bend(f, x, y);
            break;
        case FLATS:
            p[i].rank = bend(f, x, y);
            break;
        case HULL:
            p[i].rank = fmin(fmin(x, 1 - x), fmin(y, 1 - y));
            break;
        default:
            p[i].rank = brute_real(r);
        }
    }
    qsort(p, POINTS, sizeof *p, by_rank);
}

struct error {
    double all, measured, share; /* see the heading of the table */
};

static struct error error_of(struct lab_surface *s, unsigned f)
{
    struct error e = {0, 0, 0};
    double n = 0;

    for (int i = 0; i < GRID * GRID; i++) {
        const double x = (i % GRID + 0.5) / GRID, y = ((double)(i / GRID) + 0.5) / GRID;
        const struct ivec2 q = {(int32_t)lround(x * LAB_UNIT),
                                (int32_t)lround(y * LAB_UNIT)};
        bool inside;
        const double off =
            fabs(lab_height(s, q, &inside) / LAB_UNIT - lab_function(f, x, y));

        e.all += off / (GRID * GRID);
        if (!inside || !holes_measured(&s->surface.mesh, s->surface.bridge, s->last))
            continue;
        e.measured += off;
        n++;
    }
    e.measured /= n > 0 ? n : 1;
    e.share = n / (GRID * GRID);
    return e;
}

/* errors(lab, kind, f, share, draws, ...): what removal leaves, draw by draw. */
static struct error mean_error(const struct lab *lab, enum kind kind, unsigned f,
                               int share, int draws, double range, struct lab_spread *all)
{
    double *v = lab_alloc((size_t)draws, sizeof *v);
    struct lab_surface s = {0};
    struct error sum = {0, 0, 0};

    for (int d = 0; d < draws; d++) {
        struct brute_rng r = {lab->seed + (uint64_t)d};
        struct ranked p[POINTS];
        struct ivec3 pts[POINTS];
        const int k = POINTS * share / 100;
        struct error e;

        for (int i = 0; i < POINTS; i++) {
            p[i].x = brute_real(&r);
            p[i].y = brute_real(&r);
        }
        rank(kind, f, p, &r);
        for (int i = k; i < POINTS; i++)
            pts[i - k] = lab_lattice(f, p[i].x, p[i].y);
        lab_must(lab_triangulate(&s, pts, (size_t)(POINTS - k)));
        e = error_of(&s, f);
        v[d] = e.all / range;
        sum.all += v[d] / draws;
        sum.measured += e.measured / range / draws;
        sum.share += e.share / draws;
    }
    *all = lab_spread(v, (size_t)draws);
    lab_surface_free(&s);
    free(v);
    return sum;
}

void removal_run(const struct lab *lab)
{
    /* Greatest less least value of each function on the square (missing: bounds.csv). */
    static const double range[LAB_FUNCTIONS] = {1.2649, 0.2222, 0.3667,
                                                0.3068, 0.3333, 0.3503};
    const int draws = lab->reduced ? 4 : 100;
    FILE *f = lab_open(lab, "removal.csv"), *m = lab_open(lab, "mean.csv");

    fprintf(f, "kind,function,removed %%,all triangles: mean error %% of the range,5 %%,"
               "95 %%,without bridges: mean,share of the square left\n");
    fprintf(m, "kind,removed %%,all triangles: mean error %% of the range,"
               "without bridges: mean,share of the square left\n");
    for (int k = 0; k < KINDS; k++)
        for (int s = 0; s < SHARES; s++) {
            struct error mean = {0, 0, 0};

            for (unsigned i = 0; i < LAB_FUNCTIONS; i++) {
                struct lab_spread all;
                const struct error e =
                    mean_error(lab, (enum kind)k, i, percent[s], draws, range[i], &all);

                fprintf(f, "%s,%s,%d,%.3f,%.3f,%.3f,%.3f,%.3f\n", kind_name[k],
                        lab_function_name(i), percent[s], 100 * e.all, 100 * all.low,
                        100 * all.high, 100 * e.measured, e.share);
                mean.all += e.all / LAB_FUNCTIONS;
                mean.measured += e.measured / LAB_FUNCTIONS;
                mean.share += e.share / LAB_FUNCTIONS;
            }
            fprintf(m, "%s,%d,%.3f,%.3f,%.3f\n", kind_name[k], percent[s], 100 * mean.all,
                    100 * mean.measured, mean.share);
        }
    lab_close(f);
    lab_close(m);
}
