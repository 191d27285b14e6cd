#include "timing.h"

#include <dlfcn.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "delaunay.h"
#include "mem.h"
#include "peers.h"
#include "select.h"

double timing_now_ms(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

void timing_start(struct timing *t)
{
    t->since = timing_now_ms();
}

void timing_stop(struct timing *t)
{
    timing_add(t, timing_now_ms() - t->since);
}

void timing_add(struct timing *t, double ms)
{
    if (t->n == t->cap) {
        t->cap = 2 * t->cap + 64;
        if ((t->ms = realloc(t->ms, t->cap * sizeof *t->ms)) == NULL)
            abort();
    }
    t->ms[t->n++] = ms;
}

double timing_median(const struct timing *t)
{
    if (t->n == 0)
        return (double)NAN;
    select_sort(t->ms, t->n);
    return (t->ms[t->n / 2] + t->ms[(t->n - 1) / 2]) / 2;
}

double timing_part(const struct timing *t, double share)
{
    if (t->n == 0)
        return (double)NAN;
    select_sort(t->ms, t->n);
    return t->ms[(size_t)(share * (double)(t->n - 1) + 0.5)];
}

void timing_free(struct timing *t)
{
    free(t->ms);
    memset(t, 0, sizeof *t);
}

double timing_bytes(void)
{
    const struct mallinfo2 m = mallinfo2();

    return (double)m.uordblks + (double)m.hblkhd;
}

const struct peers *timing_peers(void)
{
    const char *path = getenv("BENCH_PEERS");
    void *object;

    if (path == NULL || *path == '\0' || (object = dlopen(path, RTLD_NOW)) == NULL)
        return NULL;
    return dlsym(object, PEERS_SYMBOL); /* stays loaded */
}

void *timing_alloc(size_t n, size_t size)
{
    void *p = calloc(n, size);

    if (p == NULL)
        abort();
    return p;
}

void timing_must(enum status st)
{
    if (st == ST_OK)
        return;
    (void)fprintf(stderr, "bench: %s\n", status_message(st));
    exit(1);
}

void *timing_graph(const struct peers *peers, const struct mesh *m)
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

size_t timing_triangulation(const struct peers *peers, enum clouds_kind kind,
                            uint64_t first, size_t n, size_t sets, struct timing *ours,
                            struct timing *theirs)
{
    struct ivec3 **pts = timing_alloc(sets, sizeof *pts);
    void **peer = timing_alloc(sets, sizeof *peer);
    size_t *got = timing_alloc(sets, sizeof *got), points;
    struct scratch scratch = {0};
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
    scratch_free(&scratch);
    return points;
}

void timing_unit(double ms)
{
    const char *path = getenv("BENCH_UNIT");
    FILE *f = path != NULL && !isnan(ms) ? fopen(path, "w") : NULL;

    if (f == NULL)
        return;
    fprintf(f, "%.6f\n", ms);
    fclose(f);
}

void timing_target(const char *what, double value, double limit, const char *unit)
{
    const char *path = getenv("BENCH_TARGETS");
    FILE *f = path != NULL ? fopen(path, "a") : NULL;

    if (f == NULL)
        return;
    if (isnan(value))
        fprintf(f, "  %-58s %8s  %6.2f  %-12s %s\n", what, "-", limit, unit,
                "not measured");
    else
        fprintf(f, "  %-58s %8.2f  %6.2f  %-12s %s\n", what, value, limit, unit,
                value <= limit ? "yes" : "NO");
    fclose(f);
}
