/* approx.c -- how the disparity over the general triangulation differs from the exact
 * volume between the two triangulated surfaces.
 * Over a cell of the general triangulation the measure takes both surfaces for planes; a
 * surface has its own edges inside such cells, so the two differ. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brute.h"
#include "disparity.h"
#include "facegen.h"
#include "lab.h"
#include "merge.h"
#include "overlay.h"
#include "study.h"
#include "interpolate.h"

#define FACE_UNIT                                                                        \
    1e5 /* lattice units to the millimetre: a face's square is 120 mm wide */
#define PAIRS 5

static const struct {
    const char *name, *what;
} scene[PAIRS] = {
    {"apart", "F4 gentle and F6 sphere: far apart; they hardly cross"},
    {"crossing", "F1 exponential and F3 saddle: they cross"},
    {"same", "F1 exponential twice on other points: no gap but sampling"},
    {"faces", "two generated faces without noise"},
    {"noisy", "one generated face twice with 0.12 mm of noise"},
};

/* The height of a scene's surface a or b over the unit square; noise included. */
static double height_at(int k, int side, const struct facegen_face face[2],
                        struct brute_rng *r, double x, double y)
{
    static const unsigned function[3][2] = {{3, 5}, {0, 2}, {0, 0}};
    double noise = -6;

    if (k < 3)
        return lab_function(function[k][side], x, y) * LAB_UNIT;
    for (int i = 0; i < 12; i++)
        noise += brute_real(r);
    return (facegen_height(&face[k == 4 ? 0 : side], (x - 0.5) * 100, (y - 0.5) * 100) +
            (k == 4 ? 0.12 * noise : 0)) *
           FACE_UNIT;
}

static void sample(int k, int side, const struct facegen_face face[2],
                   struct brute_rng *r, size_t n, struct ivec3 *out)
{
    for (size_t i = 0; i < n; i++) {
        const double x = i < 4 ? (double)(i & 1) : brute_real(r);
        const double y = i < 4 ? (double)(i >> 1) : brute_real(r);

        out[i] =
            (struct ivec3){(int32_t)lround(x * LAB_UNIT), (int32_t)lround(y * LAB_UNIT),
                           (int32_t)lround(height_at(k, side, face, r, x, y))};
    }
}

/* general(a, b, cells): the paper's measure, holes aside: lattice units cubed. */
static double general(const struct mesh *a, const struct mesh *b, uint32_t *cells)
{
    const size_t n = (size_t)a->nv + b->nv;
    struct scratch scratch = {0};
    struct mesh g = {0};
    struct location *la = lab_alloc(a->nv, sizeof *la),
                    *lb = lab_alloc(b->nv, sizeof *lb);
    double *za = lab_alloc(a->nv, sizeof *za), *zb = lab_alloc(b->nv, sizeof *zb);
    uint32_t *b_vertex = lab_alloc(b->nv, sizeof *b_vertex);
    uint8_t *none = lab_alloc(2 * n, 1);
    float *wide = lab_alloc(n, sizeof *wide); /* a spacing that no cell exceeds */
    struct disparity_vertex *vertex = lab_alloc(n, sizeof *vertex);
    const struct surface whole_a = {
        .mesh = *a, .spacing = wide, .bridge = none, .measured = 1};
    const struct surface whole_b = {
        .mesh = *b, .spacing = wide, .bridge = none, .measured = 1};
    const struct disparity_side sa = {&whole_a, za}, sb = {&whole_b, zb};
    struct disparity d;

    for (size_t i = 0; i < n; i++)
        wide[i] = 1e9F;
    locate_mesh(a, b, lb);
    locate_mesh(b, a, la);
    interpolate_mesh(a, b, lb, zb);
    interpolate_mesh(b, a, la, za);
    disparity_gaps(&whole_a, &whole_b, la, false, za);
    disparity_gaps(&whole_b, &whole_a, lb, true, zb);
    lab_must(merge_build(a, b, lb, &scratch, &g, b_vertex));
    disparity_measure(&g, b_vertex, &sa, &sb, NULL, 1, vertex, &d);
    *cells = d.common;
    mesh_free(&g);
    scratch_free(&scratch);
    free(la);
    free(lb);
    free(za);
    free(zb);
    free(b_vertex);
    free(none);
    free(wide);
    free(vertex);
    return d.volume_mm3;
}

/* The volume between the surfaces that were sampled, without noise: on a fine grid. */
static double truth(int k, const struct facegen_face face[2])
{
    enum { SIDE = 1000 };
    double sum = 0;

    if (k == 4)
        return 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = (i % SIDE + 0.5) / SIDE,
                     y = (double)(i / SIDE) / SIDE + 0.5 / SIDE;
        struct brute_rng none = {0};

        sum +=
            fabs(height_at(k, 0, face, &none, x, y) - height_at(k, 1, face, &none, x, y));
    }
    return sum / (SIDE * SIDE);
}

static void one_scene(const struct lab *lab, int k, FILE *f, FILE *fit)
{
    static const size_t size[] = {100, 300, 1000, 3000, 10000, 30000, 100000};
    const size_t sizes = lab->reduced ? 4 : sizeof size / sizeof size[0];
    const double unit = k < 3 ? LAB_UNIT : FACE_UNIT, area = LAB_UNIT * LAB_UNIT;
    struct brute_rng r = {lab->seed + (uint64_t)k};
    struct facegen_face face[2];
    struct lab_surface a = {0}, b = {0};
    double n[8], relative[8], real;
    struct lab_fit e;

    facegen_face(1, 0, &face[0]);
    facegen_face(2, 0, &face[1]);
    real = truth(k, face);
    for (size_t i = 0; i < sizes; i++) {
        const int pairs = size[i] > 3000 ? 3 : 10;
        double over = 0, exact = 0, off = 0;
        struct ivec3 *pts = lab_alloc(size[i], sizeof *pts);
        uint32_t cells = 0;

        for (int p = 0; p < pairs; p++) {
            double v, w, whole;

            sample(k, 0, face, &r, size[i], pts);
            lab_must(lab_triangulate(&a, pts, size[i]));
            sample(k, 1, face, &r, size[i], pts);
            lab_must(lab_triangulate(&b, pts, size[i]));
            v = general(&a.surface.mesh, &b.surface.mesh, &cells);
            w = overlay_volume(&a.surface.mesh, &b.surface.mesh, &whole);
            over += v / area / pairs;
            exact += w / whole / pairs;
            off += fabs(v - w) / w / pairs;
        }
        n[i] = (double)size[i];
        relative[i] = off;
        fprintf(f, "%s,%zu,%d,%u,%.6f,%.6f,%.4f,%.6f\n", scene[k].name, size[i], pairs,
                cells, over / unit, exact / unit, 100 * off, real / unit);
        free(pts);
    }
    e = lab_fit(n, relative, sizes);
    fprintf(fit, "%s,%s,%.3f,%.3f,%.3f,%.4f\n", scene[k].name, scene[k].what, e.slope,
            e.slope - e.half, e.slope + e.half, 100 * e.c * pow(3000, e.slope));
    lab_surface_free(&a);
    lab_surface_free(&b);
}

void approx_run(const struct lab *lab)
{
    FILE *f = lab_open(lab, "approx.csv"), *fit = lab_open(lab, "fit.csv");

    fprintf(f, "pair,N,pairs drawn,cells,general triangulation: mean gap,exact overlay,"
               "mean relative difference %%,gap of the sampled surfaces\n");
    fprintf(fit, "pair,what,exponent of the difference,95 %% from,to,"
                 "difference at N = 3000 by the fit %%\n");
    for (int k = 0; k < PAIRS; k++)
        one_scene(lab, k, f, fit);
    lab_close(f);
    lab_close(fit);
}
