/* fewer.c -- simplification: what is lost with the points that are taken out, of faces and of
 * the test functions, and what simplified templates do to verification. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "brute.h"
#include "face.h"
#include "facegen.h"
#include "lab.h"
#include "lattice.h"
#include "people.h"
#include "simplify.h"
#include "study.h"

#define POINTS    PEOPLE_POINTS
#define SHARES    8
#define STRANGERS 8
#define PEOPLE    60
static const double share[SHARES] = {100, 70, 50, 30, 20, 10, 5, 3}; /* per cent kept */
#define TEMPLATES (SHARES - 1) /* the last is too few for a face */

/* Down to so many points; by the largest gap, or by the volume. */
static struct simplify_result reduce(const struct mesh *m, uint32_t least, bool by_volume,
                                     struct scratch *s, struct mesh *out)
{
    const struct simplify_limit limit = {(double)INFINITY,
                                         by_volume ? 1e300 : (double)INFINITY, least};
    struct simplify_result r;

    lab_must(simplify_mesh(m, NULL, &limit, s, out, NULL, &r));
    return r;
}

/* ---- error against the share of points kept */

static void curve(const struct lab *lab, const char *name, int function, int draws,
                  FILE *f)
{
    struct ivec3 *lattice = lab_alloc(POINTS, sizeof *lattice);
    struct dvec3 *pts = lab_alloc(POINTS, sizeof *pts);
    struct lab_surface s = {0};
    struct scratch scratch = {0};
    struct mesh small = {0};

    for (int k = 0; k < SHARES; k++) {
        double sum[4] = {0}, kept = 0;

        for (int d = 0; d < draws; d++) {
            struct brute_rng r = {lab->seed + (uint64_t)d};
            double low = INFINITY, high = -INFINITY;
            size_t n = POINTS;

            if (function < 0) {
                struct facegen_scan scan;

                facegen_default(&scan);
                scan.subject = 1 + (uint64_t)d;
                n = facegen_sample(&scan, pts);
                lab_must(lattice_from_mm(pts, n, LATTICE_PER_MM, lattice, NULL));
            } else {
                for (size_t i = 0; i < n; i++)
                    lattice[i] =
                        lab_lattice((unsigned)function, brute_real(&r), brute_real(&r));
            }
            for (size_t i = 0; i < n; i++) {
                low = fmin(low, lattice[i].z);
                high = fmax(high, lattice[i].z);
            }
            lab_must(lab_triangulate(&s, lattice, n));
            for (int v = 0; v < 2; v++) {
                const struct simplify_result e =
                    reduce(&s.surface.mesh, (uint32_t)(share[k] * (double)n / 100),
                           v == 1, &scratch, &small);

                sum[2 * v] += e.error / (high - low) / draws;
                sum[2 * v + 1] += e.disparity / (high - low) / draws;
                kept += 50.0 * e.kept / (double)n / draws;
            }
        }
        fprintf(f, "%s,%.2f,%.5f,%.5f,%.5f,%.5f\n", name, kept, 100 * sum[0],
                100 * sum[1], 100 * sum[2], 100 * sum[3]);
    }
    mesh_free(&small);
    scratch_free(&scratch);
    lab_surface_free(&s);
    free(lattice);
    free(pts);
}

/* ---- templates of fewer points */

/* A template of the given share of its points; empty where that fails to enrol. */
static void shrink(const struct face *whole, double percent, struct face_work *w,
                   struct face *out)
{
    const struct mesh *m = &whole->surface.mesh;
    struct dvec3 *pts = lab_alloc(m->nv, sizeof *pts);
    struct scratch scratch = {0};
    struct mesh small = {0};

    (void)reduce(m, (uint32_t)(percent * m->nv / 100), false, &scratch, &small);
    for (uint32_t v = 0; v < small.nv; v++)
        pts[v] =
            (struct dvec3){small.xy[v].x / LATTICE_PER_MM, small.xy[v].y / LATTICE_PER_MM,
                           small.z[v] / LATTICE_PER_MM};
    if (face_build(pts, small.nv, w, out, NULL) != ST_OK)
        out->surface.mesh.nv = 0;
    mesh_free(&small);
    scratch_free(&scratch);
    free(pts);
}

struct tally {
    double match, score, n;
};

/* One line of the table: every probe against its own template and some other people's. */
static void line(const struct face *few, const struct face *probe, size_t people,
                 double percent, struct face_work *w, FILE *f)
{
    struct tally t[2] = {{0}}; /* [1]: non-mated */
    double unclear = 0, points = 0, made = 0, n;
    clock_t start = clock();

    for (size_t i = 0; i < people; i++) {
        points += (double)few[i].surface.mesh.nv;
        made += few[i].surface.mesh.nv > 0;
        for (size_t j = 0; j <= STRANGERS && j < people; j++) {
            const struct face *template = &few[(i + j) % people];
            struct face_result r;

            if (template->surface.mesh.nv == 0)
                continue;
            lab_must(face_compare(template, &probe[i], (double)NAN, NULL, w, &r));
            t[j > 0].n++;
            t[j > 0].score += r.score;
            t[j > 0].match += r.decision == FACE_MATCH;
            unclear += r.decision == FACE_INCONCLUSIVE;
        }
    }
    start = clock() - start;
    n = t[0].n + t[1].n;
    fprintf(f, "%.0f,%.0f,%.0f,%.1f,%.2f,%.2f,%.2f,%.1f,%.2f\n", percent, points / made,
            (double)people - made, 100 * t[0].match / t[0].n, t[0].score / t[0].n,
            100 * t[1].match / t[1].n, t[1].score / t[1].n, 100 * unclear / n,
            1e3 * (double)start / CLOCKS_PER_SEC / n);
}

static void templates(const struct lab *lab, const char *name, const struct person *p,
                      size_t people, struct face_work *w)
{
    struct face *few = lab_alloc(people, sizeof *few);
    struct face *probe = lab_alloc(people, sizeof *probe);
    FILE *f = lab_open(lab, name);

    for (size_t i = 0; i < people; i++)
        lab_must(face_build(p[i].probe, p[i].n, w, &probe[i], NULL));
    fprintf(f, "points kept %%,points,failures to enrol,mated: match %%,"
               "mean score,non-mated: match %%,mean score,inconclusive %%,"
               "a comparison ms\n");
    for (int k = 0; k < TEMPLATES; k++) {
        for (size_t i = 0; i < people; i++)
            shrink(&p[i].template, share[k], w, &few[i]);
        line(few, probe, people, share[k], w, f);
    }
    lab_close(f);
    for (size_t i = 0; i < people; i++) {
        face_free(&few[i]);
        face_free(&probe[i]);
    }
    free(few);
    free(probe);
}

static void verify(const struct lab *lab)
{
    struct face_work *w = face_work_new(NULL);
    struct person *p = lab_alloc(PEOPLE, sizeof *p);
    size_t people = lab->reduced ? 4 : PEOPLE;

    if (w == NULL)
        lab_must(ST_ENOMEM);
    people_made_up(500, people, w, p);
    templates(lab, "verify.csv", p, people, w);
    people_free(p, people);
    if (lab->faces != NULL) {
        memset(p, 0, PEOPLE * sizeof *p);
        people = people_scanned(lab->faces, "p1", people, w, p);
        templates(lab, "verify-scans.csv", p, people, w);
        people_free(p, people);
    }
    face_work_free(w);
    free(p);
}

void fewer_run(const struct lab *lab)
{
    const int draws = lab->reduced ? 2 : 10;
    FILE *f = lab_open(lab, "curves.csv");

    fprintf(f, "surface,points kept %%,by the largest gap: largest gap %% of the range,"
               "mean gap,by the volume: largest gap,mean gap\n");
    curve(lab, "faces", -1, draws, f);
    for (int i = 0; i < LAB_FUNCTIONS; i++)
        curve(lab, lab_function_name((unsigned)i), i, draws, f);
    lab_close(f);
    verify(lab);
}
