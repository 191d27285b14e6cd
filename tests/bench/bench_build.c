/* bench_build.c -- building a face from a scan as it leaves its scanner: kinds that cost about what
 * real ones do.  Median, 90 % and 99 %: covered faces, and those unlike the model's, are fitted several
 * times. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudpoints.h"
#include "clouds.h"
#include "face.h"
#include "facegen.h"
#include "headscan.h"
#include "lattice.h"
#include "mem.h"
#include "peers.h"
#include "scan.h"
#include "timing.h"

#define SCANS  40
#define ROUNDS 5

/* Of ten scans the first have the first kind of headscan.h, and so on. */
struct kind {
    const char *name;
    const char *head[10]; /* NULL: facegen's frontal scan */
    double holes;         /* share that is cut out, at most */
    size_t points;        /* of a view */
    double step, noise;   /* mm; step: of a grid */
    double median;        /* target in units */
    bool late;            /* 90 % have a target */
};

#define ALL(kind)                                                                        \
    {                                                                                    \
        kind, kind, kind, kind, kind, kind, kind, kind, kind, kind                       \
    }

static const struct kind kinds[] = {
    {"plain frontal, 3,000 points", ALL(NULL), 0, 0, 0, 0.2, 3.6, false},
    {"the same with holes and spikes", ALL(NULL), 0.45, 0, 0, 0.35, 4.3, true},
    {"whole head, 4,000 points; hair, beards",
     {"head", "beard", "fringe", "head", "beard", "fringe", "head", "beard", "head",
      "fringe"},
     0,
     4000,
     0,
     0.15,
     5.7,
     true},
    {"the same with glasses", ALL("glasses"), 0, 4000, 0, 0.15, (double)NAN, false},
    {"coarse sensor, 9,000 points", ALL("head"), 0, 9000, 0, 2.2, 7.1, false},
    {"dense sensor, 50,000 points", ALL("grid"), 0, 0, 0.8, 0.1, 5.7, true},
};
#define KINDS (sizeof kinds / sizeof *kinds)

struct points {
    struct dvec3 *at;
    size_t n;
};

static const struct peers *peers;
static struct surface_work *work;

static void make_frontal(const struct kind *k, uint64_t seed, struct points *out)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = seed;
    s.scan = 1;
    s.noise = k->noise;
    s.holes = k->holes * (double)(1 + seed % 3) / 3;
    s.spikes = k->holes > 0 ? 0.012 : 0;
    facegen_pose(&s, 5, 8);
    out->at = timing_alloc(s.points, sizeof *out->at);
    out->n = facegen_sample(&s, out->at);
}

static void make_head(const struct kind *k, uint64_t seed, struct points *out)
{
    struct headscan_options o;
    struct headscan scan;
    struct head head = {0};

    head_make_up(seed, &head);
    head_measure(&head);
    (void)headscan_kind(k->head[seed % 10], seed, false, &o);
    o.points = k->points;
    o.step = k->step;
    o.noise = k->noise;
    headscan_render(&head, &o, &scan);
    *out = (struct points){timing_alloc(scan.n, sizeof *out->at), 0};
    for (size_t i = 0; i < scan.n; i++)
        if (!isnan(scan.at[i].z))
            out->at[out->n++] = scan.at[i];
    headscan_free(&scan);
    head_free(&head);
}

/* False: refused, as some real scans of glasses are. */
static bool build(const struct points *p, struct timing *t)
{
    static const struct scan_options as_found;
    static struct surface_face face;
    struct cloudpoints c = {
        .at = mem_array(p->n, sizeof *p->at), .n = p->n, .read = p->n};
    struct surface_found found;
    enum status st;

    if (c.at == NULL)
        timing_must(ST_ENOMEM);
    memcpy(c.at, p->at, p->n * sizeof *p->at);
    timing_start(t);
    st = scan_build(&c, &as_found, work, &face, NULL, &found);
    timing_stop(t);
    if (st != ST_ENOTFACE && st != ST_ENOFACE)
        timing_must(st);
    cloudpoints_free(&c);
    return st == ST_OK;
}

/* CGAL's triangulation of a plain face. */
static void unit(const struct points *p, struct timing *t)
{
    struct ivec3 *lattice = timing_alloc(p->n, sizeof *lattice);
    void *points, *dt;

    timing_must(lattice_from_mm(p->at, p->n, LATTICE_PER_MM, lattice, NULL));
    points = peers->points(lattice, p->n);
    timing_start(t);
    dt = peers->triangulate(points);
    timing_stop(t);
    peers->triangulation_free(dt);
    peers->points_free(points);
    free(lattice);
}

static void line(const char *what, const struct timing *t, double one)
{
    const double median = timing_median(t);

    printf("  %-40s %8.2f %8.2f %8.2f", what, median, timing_part(t, 0.9),
           timing_part(t, 0.99));
    if (!isnan(one))
        printf(" %8.2f", median / one);
    putchar('\n');
}

/* A scan counts once, by the median of its rounds: 90 % is of scans, not of what disturbed some. */
static void report(struct timing each[KINDS][SCANS], const struct timing *units)
{
    const double one = timing_median(units);
    double plain = (double)NAN;

    printf("Building a face: %d scans of each kind\n", SCANS);
    printf("  %-40s %8s %8s %8s %8s\n", "", "median", "90 % ms", "99 % ms", "units");
    for (size_t k = 0; k < KINDS; k++) {
        struct timing t = {0};

        for (size_t i = 0; i < SCANS; i++)
            timing_add(&t, timing_median(&each[k][i]));
        line(kinds[k].name, &t, one);
        plain = k == 0 ? timing_median(&t) : plain;
        if (!isnan(kinds[k].median))
            timing_target(kinds[k].name, timing_median(&t) / one, kinds[k].median,
                          "units");
        if (kinds[k].late)
            timing_target("  90 % of these", timing_part(&t, 0.9) / plain, 2,
                          "x plain's");
        timing_free(&t);
    }
}

int main(void)
{
    static struct points scan[KINDS][SCANS];
    static struct timing each[KINDS][SCANS];
    struct timing units = {0};
    unsigned refused = 0;

    peers = timing_peers();
    if ((work = surface_work_new(NULL)) == NULL)
        timing_must(ST_ENOMEM);
    for (size_t k = 0; k < KINDS; k++)
        for (size_t i = 0; i < SCANS; i++)
            if (kinds[k].head[0] == NULL)
                make_frontal(&kinds[k], i, &scan[k][i]);
            else
                make_head(&kinds[k], i, &scan[k][i]);
    for (int r = 0; r < ROUNDS; r++)
        for (size_t i = 0; i < SCANS; i++) {
            for (size_t k = 0; k < KINDS; k++)
                refused += !build(&scan[k][i], &each[k][i]);
            if (peers != NULL)
                unit(&scan[0][i], &units);
        }
    report(each, &units);
    printf("  %u of %zu refused\n", refused / ROUNDS, KINDS * SCANS);
    surface_work_free(work);
    return 0;
}
