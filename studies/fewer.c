/* fewer.c -- simplification: what is lost with the points that are taken out, of faces and of
 * the test functions, and what simplified templates do to verification. */
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "brute.h"
#include "face.h"
#include "facegen.h"
#include "lab.h"
#include "lattice.h"
#include "mem.h"
#include "simplify.h"
#include "study.h"

#define POINTS    3000
#define SHARES    8
#define STRANGERS 8
static const double share[SHARES] = {100, 70, 50, 30, 20, 10, 5, 3}; /* per cent kept */
#define TEMPLATES (SHARES - 1) /* the last is too few for a face */

static size_t scan(uint64_t subject, uint64_t number, double degrees, struct dvec3 *out)
{
    struct facegen_scan s;

    facegen_default(&s);
    s.subject = subject;
    s.scan = number;
    facegen_pose(&s, degrees, degrees);
    return facegen_sample(&s, out);
}

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
                n = scan(1 + (uint64_t)d, 0, 0, pts);
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
                    reduce(&s.mesh, (uint32_t)(share[k] * (double)n / 100), v == 1,
                           &scratch, &small);

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

struct person {
    struct face whole, probe, few;
};

static void make(const struct dvec3 *pts, size_t n, struct face_work *w, struct face *out)
{
    lab_must(face_build(pts, n, w, out, NULL));
}

static void shrink(struct person *p, double percent, struct face_work *w)
{
    const struct mesh *m = &p->whole.mesh;
    struct dvec3 *pts = lab_alloc(m->nv, sizeof *pts);
    struct scratch scratch = {0};
    struct mesh small = {0};

    (void)reduce(m, (uint32_t)(percent * m->nv / 100), false, &scratch, &small);
    for (uint32_t v = 0; v < small.nv; v++)
        pts[v] =
            (struct dvec3){small.xy[v].x / LATTICE_PER_MM, small.xy[v].y / LATTICE_PER_MM,
                           small.z[v] / LATTICE_PER_MM};
    make(pts, small.nv, w, &p->few);
    mesh_free(&small);
    scratch_free(&scratch);
    free(pts);
}

static void templates(const struct lab *lab)
{
    const size_t people = lab->reduced ? 4 : 60;
    struct person *p = lab_alloc(people, sizeof *p);
    struct dvec3 *pts = lab_alloc(POINTS, sizeof *pts);
    struct face_work *w = face_work_new(NULL);
    FILE *f = lab_open(lab, "verify.csv");

    for (size_t i = 0; w != NULL && i < people; i++) {
        make(pts, scan(500 + i, 0, 0, pts), w, &p[i].whole);
        make(pts, scan(500 + i, 1, 8, pts), w, &p[i].probe);
    }
    lab_must(w != NULL ? ST_OK : ST_ENOMEM);
    fprintf(f, "points kept %%,points,the same person: match %%,mean disparity mm,"
               "strangers: match %%,mean disparity mm,inconclusive %%,a comparison ms\n");
    for (int k = 0; k < TEMPLATES; k++) {
        double same = 0, other = 0, unclear = 0, points = 0, mm[2] = {0};
        double n = 0, strangers = 0;
        clock_t start;

        for (size_t i = 0; i < people; i++) {
            shrink(&p[i], share[k], w);
            points += (double)p[i].few.mesh.nv / (double)people;
        }
        start = clock();
        for (size_t i = 0; i < people; i++)
            for (size_t j = 0; j <= STRANGERS && j < people; j++) {
                struct face_result r;

                lab_must(
                    face_compare(&p[(i + j) % people].few, &p[i].probe, 0, NULL, w, &r));
                n++;
                strangers += j > 0;
                mm[j > 0] += r.disparity_mm;
                unclear += r.decision == FACE_INCONCLUSIVE;
                same += j == 0 && r.decision == FACE_MATCH;
                other += j > 0 && r.decision == FACE_MATCH;
            }
        fprintf(f, "%.0f,%.0f,%.1f,%.4f,%.2f,%.4f,%.1f,%.2f\n", share[k], points,
                100 * same / (double)people, mm[0] / (double)people,
                100 * other / strangers, mm[1] / strangers, 100 * unclear / n,
                1e3 * (double)(clock() - start) / CLOCKS_PER_SEC / n);
    }
    lab_close(f);
    for (size_t i = 0; i < people; i++) {
        face_free(&p[i].whole);
        face_free(&p[i].probe);
        face_free(&p[i].few);
    }
    face_work_free(w);
    free(pts);
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
    templates(lab);
}
