/* bench_scale.c -- the paper's Tables 2 to 4 and scaling to 1,000,000 points, on face-like
 * clouds; compared with CGAL and Boost.  Many clouds of each size, in turn. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "clouds.h"
#include "delaunay.h"
#include "locate.h"
#include "mem.h"
#include "mesh.h"
#include "mst.h"
#include "peers.h"
#include "timing.h"

static const struct peers *peers;
static struct scratch scratch;

/* A scan, its mesh with the tree, and the same for the peer. */
struct scan {
    size_t n;
    struct ivec3 *pts;
    struct mesh mesh, bare; /* bare: as triangulated, before mst_build() */
    void *points, *queries, *graph, *surface;
};

static void scan_make(struct scan *s, uint64_t k, size_t n)
{
    s->pts = timing_alloc(n, sizeof *s->pts);
    s->n = clouds_make(CLOUDS_FACE, k, n, s->pts);
    timing_must(delaunay_build(s->pts, s->n, &scratch, &s->mesh));
    timing_must(mesh_copy(&s->bare, &s->mesh, 0));
    timing_must(mst_build(&s->mesh, &scratch));
    if (peers != NULL)
        s->points = peers->points(s->pts, s->n);
}

static void scan_free(struct scan *s)
{
    free(s->pts);
    mesh_free(&s->mesh);
    mesh_free(&s->bare);
    if (s->points != NULL)
        peers->points_free(s->points);
    if (s->queries != NULL)
        peers->queries_free(s->queries);
    if (s->graph != NULL)
        peers->graph_free(s->graph);
    if (s->surface != NULL)
        peers->surface_free(s->surface);
    *s = (struct scan){0};
}

/* Table 2: spanning trees. */
static void trees(void)
{
    static const double paper[] = {906, 1812, 2562, 3531, 4468};
    enum { SCANS = 4, ROUNDS = 5 };

    timing_head("Table 2: spanning tree (peer: Boost Prim)", "paper ms");
    for (size_t i = 0; i < 5; i++) {
        struct timing ours = {0}, theirs = {0};
        struct scan scan[SCANS] = {{0}};
        struct mesh m = {0};
        char what[64];

        for (size_t k = 0; k < SCANS; k++) {
            scan_make(&scan[k], 2 * k, 20000 * (i + 1));
            if (peers != NULL)
                scan[k].graph = timing_graph(peers, &scan[k].mesh);
        }
        for (int round = 0; round < ROUNDS; round++)
            for (size_t k = 0; k < SCANS; k++) {
                timing_must(mesh_copy(&m, &scan[k].bare, 0));
                TIMED(&ours, timing_must(mst_build(&m, &scratch)));
                if (peers != NULL)
                    TIMED(&theirs, peers->prim(scan[k].graph));
            }
        (void)snprintf(what, sizeof what, "%zu points", 20000 * (i + 1));
        timing_row(what, paper[i], timing_median(&ours), timing_median(&theirs));
        for (size_t k = 0; k < SCANS; k++)
            scan_free(&scan[k]);
        mesh_free(&m);
        timing_free(&ours);
        timing_free(&theirs);
    }
}

enum { LOCATE, INTERPOLATE, PEER_LOCATE, PEER_INTERPOLATE, TIMES };

/* n points of each scan of a pair located in the other's mesh, and interpolated there.  Both
 * programs have put the points into an order before: spanning tree, Hilbert's curve. */
static void locations(size_t n, struct timing t[TIMES])
{
    enum { PAIRS = 3, ROUNDS = 5 };
    struct scan scan[2 * PAIRS] = {{0}};
    struct location *loc = timing_alloc(n, sizeof *loc);
    double *h = timing_alloc(n, sizeof *h);

    for (size_t k = 0; k < 2 * PAIRS; k++) {
        scan_make(&scan[k], k, n);
        if (peers == NULL)
            continue;
        scan[k].surface = peers->surface(scan[k].pts, scan[k].n);
        scan[k].queries = peers->queries(scan[k].pts, scan[k].n);
    }
    for (int round = 0; round < ROUNDS; round++)
        for (size_t k = 0; k < 2 * PAIRS; k++) {
            const struct scan *in = &scan[k], *of = &scan[k ^ 1];

            TIMED(&t[LOCATE], locate_mesh(&in->mesh, &of->mesh, loc));
            TIMED(&t[INTERPOLATE], locate_heights(&in->mesh, &of->mesh, loc, h));
            if (peers == NULL)
                continue;
            TIMED(&t[PEER_LOCATE], peers->locate(in->surface, of->queries));
            TIMED(&t[PEER_INTERPOLATE], peers->interpolate(in->surface, of->queries, h));
        }
    for (size_t k = 0; k < 2 * PAIRS; k++)
        scan_free(&scan[k]);
    free(loc);
    free(h);
}

/* Tables 3 and 4: one scan located in another; the heights of both at the points of the other. */
static void location_table(const double (*paper)[2], size_t rows, bool both)
{
    for (size_t i = 0; i < rows; i++) {
        struct timing t[TIMES] = {{0}};
        char what[64];

        locations((size_t)paper[i][0], t);
        (void)snprintf(what, sizeof what, "%.0f points%s", paper[i][0],
                       both ? " each" : "");
        if (both)
            timing_row(what, paper[i][1], 2 * timing_median(&t[INTERPOLATE]),
                       2 * timing_median(&t[PEER_INTERPOLATE]));
        else
            timing_row(what, paper[i][1], timing_median(&t[LOCATE]),
                       timing_median(&t[PEER_LOCATE]));
        for (int k = 0; k < TIMES; k++)
            timing_free(&t[k]);
    }
}

/* About as many points in all for each size; 1,000,000 points three times. */
static void triangulations(void)
{
    static const size_t size[] = {1000, 3000, 10000, 30000, 100000, 300000, 1000000};
    enum { SCANS = 48 };

    timing_head("Triangulation, 1,000 to 1,000,000 points", "ns/point");
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        const size_t n = size[i], many = 200000 / n;
        const size_t scans = many > SCANS ? SCANS : many < 1 ? 1 : many;
        struct timing ours = {0}, theirs = {0};
        double o, t;
        char what[64];

        (void)timing_triangulation(peers, CLOUDS_FACE, 0, n, scans, &ours, &theirs);
        o = timing_median(&ours);
        t = timing_median(&theirs);
        (void)snprintf(what, sizeof what, "%zu points", n);
        timing_row(what, o * 1e6 / (double)n, o, t);
        if (n == 1000000)
            timing_target("triangulation of 1,000,000 points", o / t, 0.42, "x CGAL's");
        timing_free(&ours);
        timing_free(&theirs);
    }
}

/* The peak allocation of a triangulation of 1,000,000 points, including the given points: it
 * frees nothing before its end, so the peak is what is allocated then. */
static void memory(void)
{
    const size_t n = 1000000;
    struct ivec3 *pts = timing_alloc(n, sizeof *pts);
    struct mesh m = {0};
    double before;

    (void)clouds_make(CLOUDS_FACE, 7, n, pts);
    scratch_free(&scratch);
    before = timing_bytes() - (double)(n * sizeof *pts);
    timing_must(delaunay_build(pts, n, &scratch, &m));
    printf("\nMemory: triangulation of 1,000,000 points: %.1f MB with the points given\n",
           (timing_bytes() - before) / 1e6);
    timing_target("memory, triangulation of 1,000,000 points",
                  (timing_bytes() - before) / 1e6, 200, "MB");
    mesh_free(&m);
    free(pts);
}

int main(void)
{
    static const double table3[][2] = {
        {10000, 31}, {25000, 93}, {50000, 171}, {75000, 234}, {100000, 312}};
    static const double table4[][2] = {
        {50000, 15}, {100000, 31}, {150000, 46}, {200000, 62}};

    peers = timing_peers();
    trees();
    timing_head("Table 3: location (peer: CGAL, in Hilbert order)", "paper ms");
    location_table(table3, sizeof table3 / sizeof *table3, false);
    timing_head("Table 4: interpolation both ways (peer: CGAL)", "paper ms");
    location_table(table4, sizeof table4 / sizeof *table4, true);
    triangulations();
    memory();
    scratch_free(&scratch);
    return 0;
}
