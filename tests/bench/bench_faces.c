/* bench_faces.c -- the paper's Table 1 on 48 pairs of face-like clouds of 3,000 points, triangulation of
 * hard inputs and of 1,000 to 1,000,000 points; compared with CGAL and Boost. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clouds.h"
#include "codec.h"
#include "delaunay.h"
#include "disparity.h"
#include "face.h"
#include "holes.h"
#include "lattice.h"
#include "locate.h"
#include "mem.h"
#include "merge.h"
#include "mesh.h"
#include "mst.h"
#include "peers.h"
#include "timing.h"

#define PAIRS  48
#define POINTS 3000
#define ROUNDS 11

enum row {
    DELAUNAY,
    TREE,
    HOLES,
    LOCATE,
    INTERPOLATE,
    MERGE,
    INSERT, /* MERGE with the location of b in a: what the peer's insertion includes */
    MEASURE,
    SUM,
    STORED,  /* the same with side a decoded from a stored template */
    SCRATCH, /* our triangulation of the union from scratch */
    PEER_ONE,
    PEER_DELAUNAY,
    PEER_PRIM,
    PEER_KRUSKAL,
    PEER_LOCATE,
    PEER_INTERPOLATE,
    PEER_INSERT,
    PEER_SCRATCH,
    ROWS
};

struct side {
    struct ivec3 *pts;
    size_t n;
    struct surface own;
    struct location *loc; /* its vertices in the other's mesh */
    double *other, *peer_other;
    void *points, *queries, *surface, *graph, *dt; /* the peer's */
};

struct pair {
    struct side a, b;
    unsigned char *blob; /* a as stored in the database */
    size_t blob_size;
    struct ivec3 *both;
    void *both_points;
};

static const struct peers *peers;
static struct timing row[ROWS];
static struct scratch scratch;
static struct mesh general, whole;
static uint32_t *b_vertex;
static struct surface_face decoded;
static struct surface_work *work;
static struct disparity_vertex *vertex;

static void side_make(struct side *s, uint64_t k)
{
    s->pts = timing_alloc(POINTS, sizeof *s->pts);
    s->n = clouds_make(CLOUDS_FACE, k, POINTS, s->pts);
    s->loc = timing_alloc(POINTS, sizeof *s->loc);
    s->other = timing_alloc(POINTS, sizeof *s->other);
    s->peer_other = timing_alloc(POINTS, sizeof *s->other);
    if (peers != NULL) {
        s->points = peers->points(s->pts, s->n);
        s->queries = peers->queries(s->pts, s->n);
        s->surface = peers->surface(s->pts, s->n);
    }
}

static void pair_make(struct pair *p, uint64_t k)
{
    side_make(&p->a, 2 * k);
    side_make(&p->b, 2 * k + 1);
    p->both = timing_alloc(2 * POINTS, sizeof *p->both);
    memcpy(p->both, p->a.pts, p->a.n * sizeof *p->both);
    memcpy(p->both + p->a.n, p->b.pts, p->b.n * sizeof *p->both);
    if (peers != NULL)
        p->both_points = peers->points(p->both, p->a.n + p->b.n);
}

/* Adds the time since `since` to ms[r]; returns the time now. */
static double lap(double ms[ROWS], enum row r, double since)
{
    const double now = timing_now_ms();

    ms[r] += now - since;
    return now;
}

/* From two meshes with trees to the disparity. */
static double compare(struct side *a, struct side *b, double ms[ROWS])
{
    struct disparity_side da, db;
    struct disparity d;
    double t = timing_now_ms();

    locate_mesh(&a->own.mesh, &b->own.mesh, b->loc);
    t = lap(ms, LOCATE, t);
    ms[INSERT] = ms[LOCATE];
    locate_mesh(&b->own.mesh, &a->own.mesh, a->loc);
    t = lap(ms, LOCATE, t);
    locate_heights(&b->own.mesh, &a->own.mesh, a->loc, a->other);
    locate_heights(&a->own.mesh, &b->own.mesh, b->loc, b->other);
    t = lap(ms, INTERPOLATE, t);
    disparity_gaps(&a->own, &b->own, a->loc, false, a->other);
    disparity_gaps(&b->own, &a->own, b->loc, true, b->other);
    t = lap(ms, MEASURE, t);
    timing_must(
        merge_build(&a->own.mesh, &b->own.mesh, b->loc, &scratch, &general, b_vertex));
    t = lap(ms, MERGE, t);
    ms[INSERT] += ms[MERGE];
    da = (struct disparity_side){&a->own, a->other};
    db = (struct disparity_side){&b->own, b->other};
    disparity_measure(&general, b_vertex, &da, &db, NULL, LATTICE_PER_MM, vertex, &d);
    (void)lap(ms, MEASURE, t);
    return d.plain_mm;
}

/* Table 1 once, from points on the lattice to the disparity. */
static double table1(struct pair *p)
{
    struct side *a = &p->a, *b = &p->b;
    const double start = timing_now_ms();
    double ms[ROWS] = {0}, t = start, mm;

    timing_must(delaunay_build(a->pts, a->n, &scratch, &a->own.mesh));
    timing_must(delaunay_build(b->pts, b->n, &scratch, &b->own.mesh));
    t = lap(ms, DELAUNAY, t);
    timing_must(mst_build(&a->own.mesh, &scratch));
    timing_must(mst_build(&b->own.mesh, &scratch));
    t = lap(ms, TREE, t);
    timing_must(surface_derive(&a->own, &scratch));
    timing_must(surface_derive(&b->own, &scratch));
    (void)lap(ms, HOLES, t);
    mm = compare(a, b, ms);
    (void)lap(ms, SUM, start);
    for (int r = 0; r <= SUM; r++)
        timing_add(&row[r], ms[r]);
    return mm;
}

/* The same if a is a stored template: decoded, not triangulated. */
static double stored(struct pair *p)
{
    struct side *b = &p->b, a = p->a;
    const double start = timing_now_ms();
    double ms[ROWS], mm;

    timing_must(codec_decode(p->blob, p->blob_size, work, &decoded));
    a.own = decoded.surface;
    timing_must(delaunay_build(b->pts, b->n, &scratch, &b->own.mesh));
    timing_must(mst_build(&b->own.mesh, &scratch));
    timing_must(surface_derive(&b->own, &scratch));
    mm = compare(&a, b, ms);
    timing_add(&row[STORED], timing_now_ms() - start);
    return mm;
}

static void store(struct pair *p)
{
    decoded.surface = p->a.own;
    p->blob_size = surface_encoded_size(&decoded);
    p->blob = timing_alloc(p->blob_size, 1);
    surface_encode(&decoded, p->blob);
    decoded.surface = (struct surface){0};
}

static void scratch_union(const struct pair *p)
{
    TIMED(&row[SCRATCH],
          timing_must(delaunay_build(p->both, p->a.n + p->b.n, &scratch, &whole)));
}

static void peer_pass(struct pair *p)
{
    struct side *a = &p->a, *b = &p->b;
    void *merged, *both;
    double ms[ROWS] = {0}, t = timing_now_ms();

    TIMED(&row[PEER_ONE], a->dt = peers->triangulate(a->points));
    TIMED(&row[PEER_ONE], b->dt = peers->triangulate(b->points));
    t = lap(ms, PEER_DELAUNAY, t);
    peers->prim(a->graph);
    peers->prim(b->graph);
    t = lap(ms, PEER_PRIM, t);
    (void)peers->kruskal(a->graph);
    (void)peers->kruskal(b->graph);
    t = lap(ms, PEER_KRUSKAL, t);
    peers->locate(a->surface, b->queries);
    peers->locate(b->surface, a->queries);
    t = lap(ms, PEER_LOCATE, t);
    peers->interpolate(a->surface, b->queries, b->peer_other);
    peers->interpolate(b->surface, a->queries, a->peer_other);
    t = lap(ms, PEER_INTERPOLATE, t);
    merged = peers->merge(a->dt, b->queries);
    t = lap(ms, PEER_INSERT, t);
    both = peers->triangulate(p->both_points);
    (void)lap(ms, PEER_SCRATCH, t);
    for (int r = PEER_DELAUNAY; r < ROWS; r++)
        timing_add(&row[r], ms[r]);
    peers->triangulation_free(a->dt);
    peers->triangulation_free(b->dt);
    peers->triangulation_free(merged);
    peers->triangulation_free(both);
}

static void equal(const char *what, size_t pair, double ours, double theirs,
                  double within)
{
    if (fabs(ours - theirs) <= within)
        return;
    fprintf(stderr, "bench: pair %zu: %s: %.17g here, %.17g by the peer\n", pair, what,
            ours, theirs);
    exit(1);
}

static int by_place(const void *a, const void *b)
{
    const struct ivec3 *p = a, *q = b;

    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : (p->y > q->y) - (p->y < q->y);
}

/* The tree's length and the heights of the other surface at every vertex; returns the
 * largest difference of height. */
static double agree_side(const struct side *s, const struct side *other, size_t k)
{
    const struct mesh *m = &s->own.mesh;
    struct ivec3 *at = timing_alloc(s->n, sizeof *at); /* z: the point's number */
    double length = 0, worst = 0;

    for (uint32_t v = 1; v < m->nv; v++)
        length +=
            hypot(m->xy[v].x - m->xy[m->parent[v]].x, m->xy[v].y - m->xy[m->parent[v]].y);
    equal("length of the tree", k, length, peers->kruskal(s->graph), 1e-12 * length);
    for (size_t i = 0; i < s->n; i++)
        at[i] = (struct ivec3){s->pts[i].x, s->pts[i].y, (int32_t)i};
    qsort(at, s->n, sizeof *at, by_place);
    for (uint32_t v = 0; v < m->nv; v++) {
        const struct ivec3 here = {m->xy[v].x, m->xy[v].y, 0};
        const struct ivec3 *found = bsearch(&here, at, s->n, sizeof *at, by_place);
        const double height = s->peer_other[found->z];

        equal("outside the hull", k, s->loc[v].where == LOCATE_OUTSIDE, isnan(height), 0);
        if (!isnan(height)) {
            const double ours = locate_height(&other->own.mesh, s->loc[v], m->xy[v]);

            equal("height", k, ours, height, 1e-6);
            worst = fmax(worst, fabs(ours - height));
        }
    }
    free(at);
    return worst;
}

/* Compares our results with the peers' for every pair; exits where they differ. */
static void agree(struct pair *pair)
{
    double worst = 0;

    for (size_t k = 0; k < PAIRS; k++) {
        struct pair *p = &pair[k];
        void *one, *both;

        (void)table1(p);
        peer_pass(p);
        worst =
            fmax(worst, fmax(agree_side(&p->a, &p->b, k), agree_side(&p->b, &p->a, k)));
        one = peers->triangulate(p->a.points);
        both = peers->merge(one, p->b.queries);
        equal("vertices of the union", k, general.nv, (double)peers->vertices(both), 0);
        equal("its triangles", k, mesh_real(&general), (double)peers->faces(both), 0);
        peers->triangulation_free(one);
        peers->triangulation_free(both);
    }
    printf(
        "peers agree on all %d pairs: length of the trees, vertices and triangles of the "
        "unions;\nheights within %.2g mm\n",
        PAIRS, worst / LATTICE_PER_MM);
}

static double med(enum row r)
{
    return timing_median(&row[r]);
}

static void line(const char *name, double paper, double ours, double one, double peer)
{
    const double value[5] = {paper, ours, ours / one, peer, ours / peer};

    printf("  %-46s", name);
    for (int i = 0; i < 5; i++) {
        if (isnan(value[i]))
            printf(" %9s", "-");
        else
            printf(" %9.*f", i == 0 ? 0 : i % 2 == 1 ? 3 : 2, value[i]);
    }
    putchar('\n');
}

static void report(void)
{
    const double one = med(PEER_ONE), none = (double)NAN;

    printf(
        "\nTable 1, 2 x 3,000 points; unit: CGAL's time for one triangulation, %.3f ms\n",
        one);
    printf("  %-46s %9s %9s %9s %9s %9s\n", "", "paper ms", "ms", "units", "peer ms",
           "ratio");
    line("two triangulations (CGAL)", 124, med(DELAUNAY), one, med(PEER_DELAUNAY));
    line("two spanning trees (Boost Prim, graph given)", 203, med(TREE), one,
         med(PEER_PRIM));
    line("  the same (Boost Kruskal, graph given)", none, med(TREE), one,
         med(PEER_KRUSKAL));
    line("location both ways (CGAL, in Hilbert order)", 15, med(LOCATE), one,
         med(PEER_LOCATE));
    line("interpolation both ways (CGAL; paper: below 1)", 1, med(INTERPOLATE), one,
         med(PEER_INTERPOLATE));
    line("  both together (CGAL)", 16, med(LOCATE) + med(INTERPOLATE), one,
         med(PEER_LOCATE) + med(PEER_INTERPOLATE));
    line("general triangulation, of located points", 31, med(MERGE), one, none);
    line("  with locating one side (CGAL copy + insert)", none, med(INSERT), one,
         med(PEER_INSERT));
    line("  the union from scratch (CGAL)", none, med(SCRATCH), one, med(PEER_SCRATCH));
    line("point spacing and holes (not in the paper)", none, med(HOLES), one, none);
    line("measure", 31, med(MEASURE), one, none);
    line("sum (without the union from scratch)", 405, med(SUM), one, none);
    line("  with the template stored, not triangulated", none, med(STORED), one, none);
    printf("  the template stored: %.2f of the time from both clouds\n",
           med(STORED) / med(SUM));

    timing_target("triangulation of a face", med(DELAUNAY) / med(PEER_DELAUNAY), 0.42,
                  "x CGAL's");
    timing_target("spanning tree", med(TREE) / 2 / one, 0.25, "units");
    timing_target("location and interpolation both ways",
                  (med(LOCATE) + med(INTERPOLATE)) / one, 0.6, "units");
    timing_target("merging located points", med(MERGE) / one, 0.9, "units");
    timing_target("the same, with location", med(INSERT) / med(PEER_INSERT), 0.6,
                  "x CGAL's");
    timing_target("measure", med(MEASURE) / one, 0.25, "units");
    timing_target("the whole of Table 1, with holes", med(SUM) / one, 1.6, "units");
}

/* Times the triangulation of the sets of a kind from number `first` on, in turn, eight times each.
 * Returns the number of points of the first set. */
static size_t time_triangulation(enum clouds_kind kind, uint64_t first, size_t n,
                                 size_t sets, struct timing *ours, struct timing *theirs)
{
    struct ivec3 **pts = timing_alloc(sets, sizeof *pts);
    void **peer = timing_alloc(sets, sizeof *peer);
    size_t *got = timing_alloc(sets, sizeof *got), points;
    struct mesh m = {0};

    for (size_t k = 0; k < sets; k++) {
        pts[k] = timing_alloc(n + 72, sizeof *pts[k]);
        got[k] = clouds_make(kind, first + k, n, pts[k]);
        peer[k] = peers != NULL ? peers->points(pts[k], got[k]) : NULL;
    }
    points = got[0];
    timing_must(delaunay_build(pts[0], got[0], &scratch, &m));
    for (int round = 0; round < 8; round++)
        for (size_t k = 0; k < sets; k++) {
            void *dt;

            timing_start(ours);
            timing_must(delaunay_build(pts[k], got[k], &scratch, &m));
            timing_stop(ours);
            if (peers == NULL)
                continue;
            timing_start(theirs);
            dt = peers->triangulate(peer[k]);
            timing_stop(theirs);
            peers->triangulation_free(dt);
        }
    for (size_t k = 0; k < sets; k++) {
        free(pts[k]);
        if (peers != NULL)
            peers->points_free(peer[k]);
    }
    free(pts);
    free(peer);
    free(got);
    mesh_free(&m);
    return points;
}

/* Times the triangulation of so many point sets of a kind, prints a row, and returns the ratio to CGAL's
 * time. */
static double triangulations(const char *name, enum clouds_kind kind, uint64_t first,
                             size_t n, size_t sets)
{
    const double one = med(PEER_ONE);
    struct timing ours = {0}, theirs = {0};
    double o, t;

    n = time_triangulation(kind, first, n, sets, &ours, &theirs);
    o = timing_median(&ours);
    t = timing_median(&theirs);
    printf("  %-20s %8zu %10.0f %9.3f %9.2f %9.3f %9.2f\n", name, n, o * 1e6 / (double)n,
           o, o / one, t, o / t);
    timing_free(&ours);
    timing_free(&theirs);
    return o / t;
}

static void kinds_and_sizes(void)
{
    static const size_t size[] = {1000, 10000, 30000, 100000, 300000, 1000000};

    printf("\n%-22s %8s %10s %9s %9s %9s %9s\n", "Triangulation", "points", "ns/point",
           "ms", "units", "CGAL ms", "ratio");
    for (int kind = 0; kind < CLOUDS_KINDS; kind++) {
        const char *name = clouds_name((enum clouds_kind)kind);
        const double ratio =
            triangulations(name, (enum clouds_kind)kind, 1000, POINTS, 40);
        char what[80];

        (void)snprintf(what, sizeof what, "triangulation, %s", name);
        if (kind == CLOUDS_GRID || kind == CLOUDS_TILTED || kind == CLOUDS_CIRCLE)
            timing_target(what, ratio, 0.8, "x CGAL's");
    }
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        const size_t many = 200000 / size[i]; /* about as many points for each size */
        const double ratio = triangulations("faces", CLOUDS_FACE, 0, size[i],
                                            many > 48  ? 48
                                            : many < 1 ? 1
                                                       : many);

        if (size[i] == 1000000)
            timing_target("triangulation of 1,000,000 points", ratio, 0.42, "x CGAL's");
    }
}

/* The graph of the peer of the edges of m with their lengths. */
static void *peer_graph(const struct mesh *m)
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
    static struct pair pair[PAIRS];
    double sum = 0;

    peers = timing_peers();
    b_vertex = timing_alloc(POINTS, sizeof *b_vertex);
    if ((work = surface_work_new(NULL)) == NULL)
        timing_must(ST_ENOMEM);
    vertex = timing_alloc(2 * POINTS, sizeof *vertex);
    for (size_t k = 0; k < PAIRS; k++)
        pair_make(&pair[k], k);
    for (size_t k = 0; k < PAIRS; k++) { /* warm-up: memory grown, all pages touched */
        const double mm = table1(&pair[k]);

        store(&pair[k]);
        if (stored(&pair[k]) != mm) {
            fprintf(stderr, "bench: the stored template gives another disparity\n");
            return 1;
        }
        sum += mm;
        if (peers != NULL) {
            pair[k].a.graph = peer_graph(&pair[k].a.own.mesh);
            pair[k].b.graph = peer_graph(&pair[k].b.own.mesh);
        }
    }
    printf("%d pairs of clouds, subjects 0-%d, scans 0-%d; mean gap %.3f mm\n", PAIRS,
           PAIRS - 1, 2 * PAIRS - 1, sum / PAIRS);
    if (peers != NULL)
        agree(pair);
    for (size_t r = 0; r < ROWS; r++)
        row[r].n = 0;
    /* Each program with another pair: what it did with the same one last would help it. */
    for (int round = 0; round < ROUNDS; round++)
        for (size_t k = 0; k < PAIRS; k++) {
            (void)table1(&pair[k]);
            (void)stored(&pair[(k + PAIRS / 3) % PAIRS]);
            scratch_union(&pair[(k + 2 * PAIRS / 3) % PAIRS]);
            if (peers != NULL)
                peer_pass(&pair[k]);
        }
    report();
    kinds_and_sizes();
    memory();
    return 0;
}
