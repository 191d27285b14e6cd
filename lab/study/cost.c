/* cost.c -- the disparity-measure paper's tables 1 to 4, and what a stored template saves.
 * Processor time of the thread, medians. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "delaunay.h"
#include "disparity.h"
#include "holes.h"
#include "facegen.h"
#include "merge.h"
#include "mesh_link.h"
#include "mst.h"
#include "study.h"
#include "locate.h"
#include "lattice.h"

enum stage { TRIANGULATE, TREE, LOAD, LOCATE, INTERPOLATE, MERGE, MEASURE, STAGES };

/* LOAD: a stored template's triangulation and tree, from its arrays, all of it checked. */
static const char *const stage_name[STAGES] = {
    "triangulation", "spanning tree", "stored template: load",
    "location",      "interpolation", "general triangulation",
    "measure"};

/* Two clouds, and everything the paper does with them. */
struct cost_pair {
    struct ivec3 *pts[2];
    size_t n[2];
    struct study_surface side[2];
    struct location *loc[2];
    double *other[2];
    struct mesh general, stored;
    uint32_t *b_vertex;
    struct disparity_vertex *vertex;
    struct scratch scratch;
    struct disparity out;
};

static void pair_room(struct cost_pair *p)
{
    const size_t n[2] = {p->n[0], p->n[1]};

    for (int i = 0; i < 2; i++) {
        p->loc[i] = study_alloc(n[i], sizeof *p->loc[i]);
        p->other[i] = study_alloc(n[i], sizeof *p->other[i]);
    }
    p->b_vertex = study_alloc(n[1], sizeof *p->b_vertex);
    p->vertex = study_alloc(n[0] + n[1], sizeof *p->vertex);
}

static void pair_free(struct cost_pair *p)
{
    for (int i = 0; i < 2; i++) {
        free(p->pts[i]);
        free(p->loc[i]);
        free(p->other[i]);
        study_surface_free(&p->side[i]);
    }
    free(p->b_vertex);
    free(p->vertex);
    mesh_free(&p->general);
    mesh_free(&p->stored);
    scratch_free(&p->scratch);
}

/* ---- times */

#define SAMPLES 1000 /* of a stage, at most */

struct timing {
    double ms[SAMPLES];
    size_t n;
};

/* Processor time of this thread: waiting does not count. */
static double now_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static double lap(struct timing *t, double since)
{
    if (t->n < SAMPLES)
        t->ms[t->n++] = now_ms() - since;
    return now_ms();
}

/* ---- the paper's stages */

/* The points of made-up face k / 2, as scan k. */
static size_t make_cloud(uint64_t k, size_t n, struct ivec3 *out)
{
    struct dvec3 *mm = study_alloc(n, sizeof *mm);
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = k / 2;
    s.scan = k;
    s.points = (uint32_t)n;
    n = facegen_sample(&s, mm);
    study_must(lattice_from_mm(mm, n, LATTICE_PER_MM, out, NULL));
    free(mm);
    return n;
}

/* A mesh's arrays as a stored template has them, for mesh_link(). */
static void strip(struct mesh *m)
{
    uint32_t *list = study_alloc(m->nt, sizeof *list), n = 0;

    for (uint32_t h = 0; h < 3 * m->nt; h++)
        if (mesh_listed(m, h)) {
            list[n++] = h;
            list[n++] = m->twin[h];
        }
    for (uint32_t t = 0; t < m->nt; t++) {
        *(m->org[3 * t + 2] == m->nv ? &m->twin[3 * t] : &m->org[3 * t]) = UINT32_MAX;
        m->org[3 * t + 1] = list[t];
        m->twin[3 * t + 1] = m->twin[3 * t + 2] = UINT32_MAX;
    }
    memset(m->out, 0xff, (m->nv + 1) * sizeof *m->out);
    free(list);
}

/* build(p, i, row): a side's triangulation and tree. */
static void cost_build(struct cost_pair *p, int i, struct timing row[STAGES])
{
    double t = now_ms();

    study_must(delaunay_build(p->pts[i], p->n[i], &p->scratch, &p->side[i].surface.mesh));
    t = lap(&row[TRIANGULATE], t);
    study_must(mst_build(&p->side[i].surface.mesh, &p->scratch));
    (void)lap(&row[TREE], t);
    study_must(surface_derive(&p->side[i].surface, &p->scratch));
}

/* pass(p, row): the paper's stages once, each timed for both sides together but the first
 * two, which are timed for each. */
static void pass(struct cost_pair *p, struct timing row[STAGES])
{
    const struct mesh *a = &p->side[0].surface.mesh, *b = &p->side[1].surface.mesh;
    double t;

    for (int i = 0; i < 2; i++)
        cost_build(p, i, row);
    study_must(mesh_copy(&p->stored, a, 0));
    strip(&p->stored);
    t = now_ms();
    study_must(mesh_link(&p->stored, &p->scratch));
    t = lap(&row[LOAD], t);
    locate_mesh(a, b, p->loc[1]);
    locate_mesh(b, a, p->loc[0]);
    t = lap(&row[LOCATE], t);
    locate_heights(a, b, p->loc[1], p->other[1]);
    locate_heights(b, a, p->loc[0], p->other[0]);
    disparity_gaps(&p->side[0].surface, &p->side[1].surface, p->loc[0], false,
                   p->other[0]);
    disparity_gaps(&p->side[1].surface, &p->side[0].surface, p->loc[1], true,
                   p->other[1]);
    t = lap(&row[INTERPOLATE], t);
    study_must(merge_build(a, b, p->loc[1], &p->scratch, &p->general, p->b_vertex));
    t = lap(&row[MERGE], t);
    disparity_measure(&p->general, p->b_vertex,
                      &(struct disparity_side){&p->side[0].surface, p->other[0]},
                      &(struct disparity_side){&p->side[1].surface, p->other[1]}, NULL,
                      1000, p->vertex, &p->out);
    (void)lap(&row[MEASURE], t);
}

/* ---- tables 1 and the stored template */

static void table1(const struct study *study)
{
    enum { PAIRS = 24 };
    const int pairs = study->reduced ? 3 : PAIRS, rounds = study->reduced ? 2 : 9;
    static const double paper[STAGES] = {124, 203, NAN, 15, 1, 31, 31};
    /* Of both clouds' cost, what is left with one of them stored. */
    static const double left[STAGES] = {0.5, 0.5, 1, 1, 1, 1, 1};
    struct cost_pair *p = study_alloc(PAIRS, sizeof *p);
    struct timing *row = study_alloc(STAGES, sizeof *row);
    double sum[4] = {0, 0, 0, 0};
    FILE *f = study_open(study, "table1.csv");

    for (int k = 0; k < pairs; k++) {
        for (int i = 0; i < 2; i++) {
            p[k].pts[i] = study_alloc(3000, sizeof *p[k].pts[i]);
            p[k].n[i] =
                make_cloud(2 * study->seed + (uint64_t)(2 * k + i), 3000, p[k].pts[i]);
        }
        pair_room(&p[k]);
        pass(&p[k], row);
    }
    for (int s = 0; s < STAGES; s++)
        row[s].n = 0; /* the first pass was to warm up */
    for (int r = 0; r < rounds; r++)
        for (int k = 0; k < pairs; k++)
            pass(&p[k], row);
    fprintf(
        f, "stage,paper: both from points ms,one stored by the paper ms,both from points "
           "ms,one stored ms,stored / both\n");
    for (int s = 0; s < STAGES; s++) {
        const double ms =
            study_spread(row[s].ms, row[s].n).median * (left[s] < 1 ? 2 : 1);
        const double both = s == LOAD ? 0 : ms, one = ms * left[s];
        const double p_both = s == LOAD ? 0 : paper[s], p_one = p_both * left[s];

        sum[0] += p_both;
        sum[1] += p_one;
        sum[2] += both;
        sum[3] += one;
        fprintf(f, "%s,%.0f,%.0f,%.3f,%.3f,%.2f\n", stage_name[s], p_both, p_one, both,
                one, both > 0 ? one / both : 1);
    }
    fprintf(f, "sum,%.0f,%.0f,%.3f,%.3f,%.2f\n", sum[0], sum[1], sum[2], sum[3],
            sum[3] / sum[2]);
    study_close(f);
    for (int k = 0; k < pairs; k++)
        pair_free(&p[k]);
    free(p);
    free(row);
}

/* ---- tables 2 to 4: the first n points of two large clouds in random order */

static void cost_measure(const struct study *study, const struct ivec3 *const all[2],
                         size_t n, double ms[STAGES])
{
    const size_t rounds = study->reduced ? 1 : n > 30000 ? 9 : 600000 / n + 3;
    struct timing *row = study_alloc(STAGES, sizeof *row);
    struct cost_pair p = {.n = {n, n}};

    for (int i = 0; i < 2; i++) {
        p.pts[i] = study_alloc(n, sizeof *p.pts[i]);
        memcpy(p.pts[i], all[i], n * sizeof *p.pts[i]);
    }
    pair_room(&p);
    pass(&p, row);
    for (int s = 0; s < STAGES; s++)
        row[s].n = 0;
    for (size_t r = 0; r < (rounds < 60 ? rounds : 60); r++)
        pass(&p, row);
    for (int s = 0; s < STAGES; s++)
        ms[s] = study_spread(row[s].ms, row[s].n).median;
    pair_free(&p);
    free(row);
}

static void papers(const struct study *study, const struct ivec3 *const all[2],
                   size_t most)
{
    static const struct {
        int table;
        size_t n;
        enum stage s;
        double paper;
    } row[] = {
        {2, 20000, TREE, 906},        {2, 40000, TREE, 1812},
        {2, 60000, TREE, 2562},       {2, 80000, TREE, 3531},
        {2, 100000, TREE, 4468},      {3, 10000, LOCATE, 31},
        {3, 25000, LOCATE, 93},       {3, 50000, LOCATE, 171},
        {3, 75000, LOCATE, 234},      {3, 100000, LOCATE, 312},
        {4, 50000, INTERPOLATE, 15},  {4, 100000, INTERPOLATE, 31},
        {4, 150000, INTERPOLATE, 46}, {4, 200000, INTERPOLATE, 62},
    };
    static const char *const what[] = {"spanning tree of one mesh",
                                       "location of one mesh in the other",
                                       "interpolation of both"};
    FILE *f = study_open(study, "tables.csv"), *fit = study_open(study, "tables-fit.csv");
    double n[8], printed[8], ours[8];
    size_t k = 0;

    fprintf(f, "table,what,points,paper ms,here ms,paper / here,paper us a point,"
               "here us a point\n");
    fprintf(fit,
            "table,what,paper: exponent,95 %% from,to,here: exponent,95 %% from,to\n");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        double ms[STAGES];
        const double points = (double)row[i].n;

        if (row[i].n <= most) {
            cost_measure(study, all, row[i].n, ms);
            /* The paper locates one mesh in the other; the pass does it both ways. */
            ours[k] = ms[row[i].s] / (row[i].s == LOCATE ? 2 : 1);
            n[k] = points;
            printed[k++] = row[i].paper;
            fprintf(f, "%d,%s,%zu,%.0f,%.3f,%.0f,%.2f,%.3f\n", row[i].table,
                    what[row[i].table - 2], row[i].n, row[i].paper, ours[k - 1],
                    row[i].paper / ours[k - 1], 1e3 * row[i].paper / points,
                    1e3 * ours[k - 1] / points);
        }
        if (i + 1 == sizeof row / sizeof row[0] || row[i + 1].table != row[i].table) {
            if (k >= 3) {
                const struct study_fit a = study_fit(n, printed, k),
                                       b = study_fit(n, ours, k);

                fprintf(fit, "%d,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f\n", row[i].table,
                        what[row[i].table - 2], a.slope, a.slope - a.half,
                        a.slope + a.half, b.slope, b.slope - b.half, b.slope + b.half);
            }
            k = 0;
        }
    }
    study_close(f);
    study_close(fit);
}

void cost_run(const struct study *study)
{
    const size_t most = study->reduced ? 10000 : 200000;
    struct ivec3 *all[2];

    table1(study);
    for (int i = 0; i < 2; i++) {
        all[i] = study_alloc(most, sizeof *all[i]);
        if (make_cloud(2 * study->seed + (uint64_t)i, most, all[i]) < most)
            study_must(ST_ETOOFEW);
    }
    papers(study, (const struct ivec3 *const *)all, most);
    free(all[0]);
    free(all[1]);
}
