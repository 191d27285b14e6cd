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
#include "interpolate.h"
#include "timing.h"

#define NONE ((double)NAN)

static const struct peers *peers;
static struct scratch scratch;

static void must(enum status st)
{
    if (st == ST_OK)
        return;
    fprintf(stderr, "bench: %s\n", status_message(st));
    exit(1);
}

/* A scan, its mesh with the tree, and the same for the peer. */
struct scan {
    size_t n;
    struct ivec3 *pts;
    struct mesh mesh, bare; /* bare: as triangulated, before mst_build() */
    void *points, *graph, *surface;
};

static void scan_make(struct scan *s, uint64_t k, size_t n)
{
    s->pts = timing_alloc(n, sizeof *s->pts);
    s->n = clouds_make(CLOUDS_FACE, k, n, s->pts);
    must(delaunay_build(s->pts, s->n, &scratch, &s->mesh));
    must(mesh_copy(&s->bare, &s->mesh, 0));
    must(mst_build(&s->mesh, &scratch));
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
    if (s->graph != NULL)
        peers->graph_free(s->graph);
    if (s->surface != NULL)
        peers->surface_free(s->surface);
    *s = (struct scan){0};
}

static void *graph_of(const struct mesh *m)
{
    uint32_t(*edges)[2] = timing_alloc(3 * (size_t)m->nv, sizeof *edges);
    double *length = timing_alloc(3 * (size_t)m->nv, sizeof *length);
    void *graph;
    size_t n = 0;

    for (uint32_t h = 0; h < 3 * m->nt; h++) {
        const uint32_t u = m->org[h], v = mesh_dest(m, h);

        if (u >= m->nv || v >= m->nv || u > v)
            continue;
        edges[n][0] = u;
        edges[n][1] = v;
        length[n++] = hypot(m->xy[u].x - m->xy[v].x, m->xy[u].y - m->xy[v].y);
    }
    graph = peers->graph(m->nv, (const uint32_t(*)[2])edges, length, n);
    free(edges);
    free(length);
    return graph;
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
                scan[k].graph = graph_of(&scan[k].mesh);
        }
        for (int round = 0; round < ROUNDS; round++)
            for (size_t k = 0; k < SCANS; k++) {
                must(mesh_copy(&m, &scan[k].bare, 0));
                timing_start(&ours);
                must(mst_build(&m, &scratch));
                timing_stop(&ours);
                if (peers != NULL) {
                    timing_start(&theirs);
                    peers->prim(scan[k].graph);
                    timing_stop(&theirs);
                }
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

/* Tables 3 and 4: n points of one scan located in another's mesh; interpolation of both. */
static void locations(size_t n, double paper_locate, double paper_interpolate)
{
    enum { PAIRS = 3, ROUNDS = 5 };
    struct timing locate = {0}, interpolate = {0}, theirs = {0};
    struct scan scan[2 * PAIRS] = {{0}};
    struct location *loc[2] = {timing_alloc(n, sizeof *loc[0]),
                               timing_alloc(n, sizeof *loc[0])};
    double *h = timing_alloc(n, sizeof *h);
    char what[64];

    for (size_t k = 0; k < 2 * PAIRS; k++)
        scan_make(&scan[k], k, n);
    for (size_t k = 0; peers != NULL && k < 2 * PAIRS; k++)
        scan[k].surface = peers->surface(scan[k].pts, scan[k].n);
    for (int round = 0; round < ROUNDS; round++)
        for (size_t k = 0; k < 2 * PAIRS; k += 2) {
            const struct mesh *a = &scan[k].mesh, *b = &scan[k + 1].mesh;
            double t0, t1;

            timing_start(&locate);
            locate_mesh(a, b, loc[1]);
            timing_stop(&locate);
            locate_mesh(b, a, loc[0]);
            timing_start(&interpolate);
            interpolate_mesh(a, b, loc[1], h);
            interpolate_mesh(b, a, loc[0], h);
            timing_stop(&interpolate);
            if (peers == NULL)
                continue;
            t0 = timing_now_ms();
            peers->locate(scan[k].surface, scan[k + 1].points, h);
            t1 = timing_now_ms();
            timing_add(&theirs, t1 - t0);
        }
    if (!isnan(paper_locate)) {
        (void)snprintf(what, sizeof what, "location, %zu points", n);
        timing_row(what, paper_locate, timing_median(&locate), timing_median(&theirs));
    }
    if (!isnan(paper_interpolate)) {
        (void)snprintf(what, sizeof what, "interpolation of both, %zu points each", n);
        timing_row(what, paper_interpolate, timing_median(&interpolate), NONE);
    }
    for (size_t k = 0; k < 2 * PAIRS; k++)
        scan_free(&scan[k]);
    free(loc[0]);
    free(loc[1]);
    free(h);
    timing_free(&locate);
    timing_free(&interpolate);
    timing_free(&theirs);
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
        struct ivec3 *pts[SCANS] = {NULL};
        void *peer[SCANS] = {NULL};
        size_t got[SCANS];
        struct timing ours = {0}, theirs = {0};
        struct mesh m = {0};
        double o, t;
        char what[64];

        for (size_t k = 0; k < scans; k++) {
            pts[k] = timing_alloc(n, sizeof *pts[k]);
            got[k] = clouds_make(CLOUDS_FACE, k, n, pts[k]);
            peer[k] = peers != NULL ? peers->points(pts[k], got[k]) : NULL;
        }
        must(delaunay_build(pts[0], got[0], &scratch, &m));
        for (int round = 0; round < 5; round++)
            for (size_t k = 0; k < scans; k++) {
                void *dt;

                timing_start(&ours);
                must(delaunay_build(pts[k], got[k], &scratch, &m));
                timing_stop(&ours);
                if (peers == NULL)
                    continue;
                timing_start(&theirs);
                dt = peers->triangulate(peer[k]);
                timing_stop(&theirs);
                peers->triangulation_free(dt);
            }
        o = timing_median(&ours);
        t = timing_median(&theirs);
        (void)snprintf(what, sizeof what, "%zu points", n);
        timing_row(what, o * 1e6 / (double)n, o, t);
        if (n == 1000000)
            timing_target("triangulation of 1,000,000 points", o / t, 1.0, "x CGAL's");
        for (size_t k = 0; k < scans; k++) {
            free(pts[k]);
            if (peer[k] != NULL)
                peers->points_free(peer[k]);
        }
        mesh_free(&m);
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
    must(delaunay_build(pts, n, &scratch, &m));
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
    timing_head("Table 3: location (peer: CGAL, with interpolation)", "paper ms");
    for (size_t i = 0; i < sizeof table3 / sizeof table3[0]; i++)
        locations((size_t)table3[i][0], table3[i][1], NONE);
    timing_head("Table 4: interpolation of both functions", "paper ms");
    for (size_t i = 0; i < sizeof table4 / sizeof table4[0]; i++)
        locations((size_t)table4[i][0], NONE, table4[i][1]);
    triangulations();
    memory();
    scratch_free(&scratch);
    return 0;
}
