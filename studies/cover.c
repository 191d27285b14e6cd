/* cover.c -- faces with parts missing: up to 85 % of a probe's points cut out in blobs.
 * How far the surface that is left lies from the true one, with and without the triangles
 * that bridge a hole, and how verification decides: the evidence for the share below which a
 * comparison is inconclusive.
 * People: made up (sim/facegen.h), and besides the scans of a folder, if one is given:
 * SUBJECT_enroll.ply with SUBJECT_p1.ply. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brute.h"
#include "face.h"
#include "facegen.h"
#include "holes.h"
#include "lab.h"
#include "lattice.h"
#include "people.h"
#include "study.h"
#include "interpolate.h"

#define SHARES 8
static const double share[SHARES] = {0, 0.15, 0.30, 0.45, 0.60, 0.75, 0.85, 0.92};

#define OTHERS 8 /* other people's templates that each probe is compared with */

/* cut(pts, n, goal, r): cut blobs 12 to 30 mm wide out until no more than goal points are
 * left; returns how many. */
static size_t cut(struct dvec3 *p, size_t n, size_t goal, struct brute_rng *r)
{
    while (n > goal && n > 1) {
        const struct dvec3 c = p[brute_rand(r) % n];
        const double radius = 6 + 9 * brute_real(r), phase = 6.28 * brute_real(r);
        size_t left = 0;

        for (size_t i = 0; i < n; i++) {
            const double dx = p[i].x - c.x, dy = p[i].y - c.y;
            const double edge = radius * (1 + 0.25 * cos(3 * atan2(dy, dx) + phase));

            if (dx * dx + dy * dy >= edge * edge)
                p[left++] = p[i];
        }
        n = left;
    }
    return n;
}

/* ---- the surface that is left against the true one */

struct fidelity {
    double all, measured, share; /* mean distance, mm; share of the outline measured */
};

/* On a grid of 1.5 mm over the whole scan's hull: mean |surface - face|, of all that the
 * triangulation covers, and of what it does not only bridge. */
static struct fidelity fidelity(const struct facegen_face *f, struct lab_surface *whole,
                                struct lab_surface *s)
{
    struct fidelity d = {0, 0, 0};
    double all = 0, measured = 0, outline = 0;

    for (int j = -60; j <= 60; j++)
        for (int i = -45; i <= 45; i++) {
            const struct ivec2 q = {1500 * i, 1500 * j};
            bool inside;
            double off;

            (void)lab_height(whole, q, &inside);
            outline += inside;
            off = fabs(lab_height(s, q, &inside) / LATTICE_PER_MM -
                       facegen_height(f, 1.5 * i, 1.5 * j));
            if (!inside)
                continue;
            all++;
            d.all += off;
            if (!holes_measured(&s->surface.mesh, s->surface.bridge, s->last))
                continue;
            measured++;
            d.measured += off;
        }
    d.all /= all > 0 ? all : 1;
    d.measured /= measured > 0 ? measured : 1;
    d.share = measured / outline;
    return d;
}

static void truths(const struct lab *lab)
{
    const size_t people = lab->reduced ? 4 : 60;
    struct ivec3 *lattice = lab_alloc(PEOPLE_POINTS, sizeof *lattice);
    struct dvec3 *pts = lab_alloc(PEOPLE_POINTS, sizeof *pts);
    struct lab_surface whole = {0}, left = {0};
    FILE *f = lab_open(lab, "truth.csv");

    fprintf(f,
            "removed %%,all triangles: mean |gap| to the true face mm,median,5 %%,95 %%,"
            "without bridges: mean,median,5 %%,95 %%,share of the outline still "
            "measured\n");
    for (int k = 0; k < SHARES; k++) {
        double *all = lab_alloc(people, sizeof *all), area = 0;
        double *measured = lab_alloc(people, sizeof *measured);
        struct lab_spread a, m;

        for (size_t s = 0; s < people; s++) {
            struct brute_rng r = {lab->seed + s};
            struct facegen_scan scan;
            struct facegen_face face;
            struct fidelity d;
            size_t n;

            facegen_default(&scan);
            scan.subject = s;
            facegen_face(s, 0, &face);
            n = facegen_sample(&scan, pts);
            lab_must(lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, NULL));
            lab_must(lab_triangulate(&whole, lattice, n));
            n = cut(pts, n, (size_t)((1 - share[k]) * (double)n), &r);
            lab_must(lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, NULL));
            lab_must(lab_triangulate(&left, lattice, n));
            d = fidelity(&face, &whole, &left);
            all[s] = d.all;
            measured[s] = d.measured;
            area += d.share / (double)people;
        }
        a = lab_spread(all, people);
        m = lab_spread(measured, people);
        fprintf(f, "%.0f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.3f\n", 100 * share[k],
                a.mean, a.median, a.low, a.high, m.mean, m.median, m.low, m.high, area);
        free(all);
        free(measured);
    }
    lab_close(f);
    lab_surface_free(&whole);
    lab_surface_free(&left);
    free(lattice);
    free(pts);
}

/* ---- verification */

#define BINS 10
static const double bin_from[BINS + 1] = {0,   0.05, 0.1, 0.15, 0.2, 0.3,
                                          0.4, 0.5,  0.7, 0.9,  1.01};

/* Decisions: by the daemon's rule, and by the threshold alone. */
struct tally {
    int n, match, no_match, inconclusive, above;
    double score;
};

static void count(struct tally *t, const struct face_result *r)
{
    t->n++;
    t->match += r->decision == FACE_MATCH;
    t->no_match += r->decision == FACE_NO_MATCH;
    t->inconclusive += r->decision == FACE_INCONCLUSIVE;
    t->above += r->score >= r->threshold && r->overlap > 0;
    t->score += r->score;
}

struct outcome {
    struct tally share[SHARES][2], bin[BINS][2]; /* [1]: non-mated */
    int probes[SHARES], refused[SHARES];
};

static void one_probe(const struct lab *lab, struct person *p, size_t people, size_t who,
                      int k, uint64_t draw, struct face_work *w, struct face *probe,
                      struct outcome *o)
{
    struct brute_rng r = {lab->seed + 1000003 * draw + who};
    struct dvec3 *pts = lab_alloc(p[who].n, sizeof *pts);
    size_t n;

    memcpy(pts, p[who].probe, p[who].n * sizeof *pts);
    n = cut(pts, p[who].n, (size_t)((1 - share[k]) * (double)p[who].n), &r);
    o->probes[k]++;
    if (face_build(pts, n, w, probe, NULL) != ST_OK) {
        o->refused[k]++;
        free(pts);
        return;
    }
    for (size_t i = 0; i <= OTHERS && i < people; i++) {
        const size_t other = (who + i * (people / (OTHERS + 1) + 1)) % people;
        struct face_result res;
        int bin = 0;

        if (i > 0 && other == who)
            continue;
        lab_must(face_compare(&p[other].template, probe, (double)NAN, NULL, w, &res));
        while (bin + 1 < BINS && res.overlap >= bin_from[bin + 1])
            bin++;
        count(&o->share[k][i > 0], &res);
        count(&o->bin[bin][i > 0], &res);
    }
    free(pts);
}

static double percent(int a, int n)
{
    return n > 0 ? 100.0 * a / n : (double)NAN;
}

static void report(const struct lab *lab, const char *name, const struct outcome *o)
{
    char file[64];
    FILE *f;

    (void)snprintf(file, sizeof file, "%s.csv", name);
    f = lab_open(lab, file);
    fprintf(f, "removed %%,probes,failures to acquire,mated: match %%,non-match %%,"
               "inconclusive %%,non-mated,match %%,non-match %%,inconclusive %%\n");
    for (int k = 0; k < SHARES; k++) {
        const struct tally *g = &o->share[k][0], *i = &o->share[k][1];

        fprintf(f, "%.0f,%d,%d", 100 * share[k], o->probes[k], o->refused[k]);
        lab_field(f, 1, percent(g->match, g->n));
        lab_field(f, 1, percent(g->no_match, g->n));
        lab_field(f, 1, percent(g->inconclusive, g->n));
        fprintf(f, ",%d", i->n);
        lab_field(f, 2, percent(i->match, i->n));
        lab_field(f, 2, percent(i->no_match, i->n));
        lab_field(f, 2, percent(i->inconclusive, i->n));
        fprintf(f, "\n");
    }
    lab_close(f);
    (void)snprintf(file, sizeof file, "%s-area.csv", name);
    f = lab_open(lab, file);
    fprintf(f, "area covered from,to,mated,match by the threshold alone %%,"
               "mean score,non-mated,match by the threshold alone %%,"
               "mean score,non-mated that are conclusive,of these a match\n");
    for (int b = 0; b < BINS; b++) {
        const struct tally *g = &o->bin[b][0], *i = &o->bin[b][1];

        fprintf(f, "%.2f,%.2f,%d", bin_from[b], fmin(bin_from[b + 1], 1), g->n);
        lab_field(f, 1, percent(g->above, g->n));
        lab_field(f, 2, g->n > 0 ? g->score / g->n : (double)NAN);
        fprintf(f, ",%d", i->n);
        lab_field(f, 2, percent(i->above, i->n));
        lab_field(f, 2, i->n > 0 ? i->score / i->n : (double)NAN);
        fprintf(f, ",%d,%d\n", i->match + i->no_match, i->match);
    }
    lab_close(f);
}

/* The people and w's memory are the caller's. */
static void verify(const struct lab *lab, const char *name, struct person *p,
                   size_t people, struct face_work *w)
{
    const uint64_t draws = lab->reduced ? 1 : 2;
    struct outcome *o = lab_alloc(1, sizeof *o);
    struct face probe = {0};

    for (int k = 0; k < SHARES; k++)
        for (uint64_t d = 0; d < draws; d++)
            for (size_t s = 0; s < people; s++)
                one_probe(lab, p, people, s, k, d, w, &probe, o);
    report(lab, name, o);
    face_free(&probe);
    free(o);
}

void cover_run(const struct lab *lab)
{
    enum { MOST = 100 };
    struct face_work *w = face_work_new(NULL);
    struct person *p = lab_alloc(MOST, sizeof *p);
    size_t people = lab->reduced ? 5 : MOST;

    truths(lab);
    if (w == NULL)
        lab_must(ST_ENOMEM);
    people_made_up(0, people, w, p);
    verify(lab, "madeup", p, people, w);
    people_free(p, people);
    if (lab->faces != NULL) {
        memset(p, 0, MOST * sizeof *p);
        people = people_scanned(lab->faces, "p1", MOST, w, p);
        verify(lab, "scans", p, people, w);
        people_free(p, people);
    }
    face_work_free(w);
    free(p);
}
