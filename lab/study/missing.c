/* missing.c -- the missing-points paper: 36 points, six test functions, removal of 15, 30,
 * 45, 60 and 75 % and triangulation of the rest (its figures 2-8, tables 2 and 3).
 *
 * Which points its authors removed they do not say: here each draw removes the first points
 * of a random order, so that within a draw more removal means more of the same points.
 * Errors are those of the function that was sampled, as the paper's tables seem to mean, at
 * the removed points.  Where a point lies outside the hull of what is left,
 * the surface is that at the nearest point of the hull; the mean over those inside stands
 * beside it. */
#include <math.h>
#include <stdlib.h>

#include "study.h"

#define POINTS 36
#define SHARES 5
#define DRAWS  1000

static const double point[POINTS][2] = {
    {0.00, 0.00}, {0.50, 0.00}, {1.00, 0.00}, {0.15, 0.15}, {0.70, 0.15}, {0.50, 0.20},
    {0.25, 0.30}, {0.40, 0.30}, {0.75, 0.40}, {0.85, 0.25}, {0.55, 0.45}, {0.00, 0.50},
    {0.20, 0.45}, {0.45, 0.55}, {0.60, 0.65}, {0.25, 0.70}, {0.40, 0.80}, {0.65, 0.75},
    {0.80, 0.85}, {0.85, 0.65}, {1.00, 0.50}, {1.00, 1.00}, {0.50, 1.00}, {0.10, 0.85},
    {0.00, 1.00}, {0.25, 0.00}, {0.75, 0.00}, {0.25, 1.00}, {0.00, 0.25}, {0.75, 1.00},
    {0.00, 0.75}, {1.00, 0.25}, {1.00, 0.75}, {0.19, 0.19}, {0.32, 0.75}, {0.79, 0.46}};

static const int percent[SHARES + 1] = {0, 15, 30, 45, 60, 75};
static const int removed[SHARES + 1] = {0, 5, 11, 16, 22, 27};

/* Tables 2 and 3 as printed: rows A to E, columns F1 to F6. */
static const double total_printed[SHARES][STUDY_FUNCTIONS] = {
    {7752.31, 0.39, 1.43, 4.37, 1.65, 0},      {1881.36, 0.68, 1.17, 5.73, 3.56, 54.41},
    {1711.97, 1.43, 1.92, 9.07, 4.89, 32.93},  {1217.92, 1.84, 2.28, 10.82, 6.22, 109.64},
    {306.96, 2.74, 3.95, 15.09, 6.70, 117.14},
};
static const double mean_printed[SHARES][STUDY_FUNCTIONS] = {
    {250.18, 0.01, 0.05, 0.14, 0.05, 0},    {75.18, 0.02, 0.04, 0.23, 0.14, 2.17},
    {85.47, 0.07, 0.10, 0.46, 0.24, 1.65},  {51.01, 0.13, 0.16, 0.78, 0.45, 7.83},
    {33.41, 0.31, 0.44, 1.68, 0.74, 13.02},
};

enum error {
    E_TOTAL,  /* sum over the removed points */
    E_MEAN,   /* their mean */
    E_INSIDE, /* mean over those inside the hull that is left; NAN: none */
    ERRORS
};

/* order: the points, those to be removed first. */
static enum status triangulate(struct study_surface *s, unsigned f, const int *order,
                               int k)
{
    struct ivec3 pts[POINTS];

    for (int i = k; i < POINTS; i++)
        pts[i - k] = study_lattice(f, point[order[i]][0], point[order[i]][1]);
    return study_triangulate(s, pts, (size_t)(POINTS - k));
}

static void shuffle(int *order, struct study_random *r)
{
    for (int i = 0; i < POINTS; i++)
        order[i] = i;
    for (int i = POINTS; i-- > 1;) {
        const int j = study_int(r, 0, i), t = order[i];

        order[i] = order[j];
        order[j] = t;
    }
}

/* An order whose last nine points, and so any more of them, are not all on one line. */
static void draw(struct study_surface *s, int *order, struct study_random *r)
{
    do
        shuffle(order, r);
    while (triangulate(s, 0, order, removed[SHARES]) != ST_OK);
}

static void errors(struct study_surface *s, unsigned f, const int *order, int k,
                   double *e)
{
    double within = 0;
    int count = 0;

    study_must(triangulate(s, f, order, k));
    e[E_TOTAL] = 0;
    for (int i = 0; i < k; i++) {
        const struct ivec3 p = study_lattice(f, point[order[i]][0], point[order[i]][1]);
        bool inside;
        const double z = study_height(s, (struct ivec2){p.x, p.y}, &inside);
        const double off = fabs(z - p.z) / STUDY_UNIT;

        e[E_TOTAL] += off;
        within += inside ? off : 0;
        count += inside;
    }
    e[E_MEAN] = e[E_TOTAL] / k;
    e[E_INSIDE] = count > 0 ? within / count : (double)NAN;
}

/* ---- tables 2 and 3, 1,000 draws of each */

struct draws {
    int n;
    double *e[STUDY_FUNCTIONS][SHARES][ERRORS]; /* [n] each */
};

static struct study_spread spread(const struct draws *d, unsigned f, int share,
                                  enum error which)
{
    double *v = study_alloc((size_t)d->n, sizeof *v);
    struct study_spread s = {NAN, NAN, NAN, NAN};
    size_t n = 0;

    for (int i = 0; i < d->n; i++)
        if (!isnan(d->e[f][share][which][i]))
            v[n++] = d->e[f][share][which][i];
    if (n > 0)
        s = study_spread(v, n);
    free(v);
    return s;
}

static void all_draws(const struct study *study, struct draws *d)
{
    struct study_surface part = {0};

    for (unsigned f = 0; f < STUDY_FUNCTIONS; f++) {
        struct study_random r = {study->seed}; /* the same draws for each function */

        for (int s = 0; s < SHARES; s++)
            for (int k = 0; k < ERRORS; k++)
                d->e[f][s][k] = study_alloc((size_t)d->n, sizeof(double));
        for (int i = 0; i < d->n; i++) {
            int order[POINTS];
            double e[ERRORS];

            draw(&part, order, &r);
            for (int s = 0; s < SHARES; s++) {
                errors(&part, f, order, removed[s + 1], e);
                for (int k = 0; k < ERRORS; k++)
                    d->e[f][s][k][i] = e[k];
            }
        }
    }
    study_surface_free(&part);
}

/* The draws, in per cent, whose total is as large as the printed one or larger. */
static double reached(const struct draws *d, unsigned f, int share, double total)
{
    int n = 0;

    for (int i = 0; i < d->n; i++)
        n += d->e[f][share][E_TOTAL][i] >= total;
    return 100.0 * n / d->n;
}

/* Nothing between the commas where nothing was there to be measured. */
static void write_spread(FILE *f, struct study_spread s)
{
    const double value[] = {s.mean, s.median, s.low, s.high};

    for (int i = 0; i < 4; i++)
        if (isnan(value[i]))
            (void)fputc(',', f);
        else
            (void)fprintf(f, ",%.4f", value[i]);
}

static void tables(const struct study *study, const struct draws *d)
{
    FILE *t2 = study_open(study, "table2.csv"), *t3 = study_open(study, "table3.csv");
    const char *four = "mean,median,5 %,95 %";

    fprintf(
        t2,
        "function,removed %%,points removed,printed total,%s,draws that reach it %%\n",
        four);
    fprintf(t3,
            "function,removed %%,points left,printed mean,printed total / points left,%s,"
            "inside the hull: %s\n",
            four, four);
    for (unsigned f = 0; f < STUDY_FUNCTIONS; f++)
        for (int s = 0; s < SHARES; s++) {
            const char *name = study_function_name(f);
            const double total = total_printed[s][f];
            const int left = POINTS - removed[s + 1];

            fprintf(t2, "%s,%d,%d,%.2f", name, percent[s + 1], removed[s + 1], total);
            write_spread(t2, spread(d, f, s, E_TOTAL));
            fprintf(t2, ",%.1f\n", reached(d, f, s, total));
            fprintf(t3, "%s,%d,%d,%.2f,%.2f", name, percent[s + 1], left,
                    mean_printed[s][f], total / left);
            write_spread(t3, spread(d, f, s, E_MEAN));
            write_spread(t3, spread(d, f, s, E_INSIDE));
            fprintf(t3, "\n");
        }
    study_close(t2);
    study_close(t3);
}

/* ---- figures 2 to 8: one draw, the first of the tables' */
static void missing_figures(const struct study *study)
{
    struct study_random r = {study->seed};
    struct study_surface s = {0};
    FILE *edges = study_open(study, "fig2-edges.csv"),
         *pts = study_open(study, "fig2-points.csv");
    int order[POINTS];

    draw(&s, order, &r);
    for (int k = 0; k <= SHARES; k++) {
        char tag[8];

        (void)snprintf(tag, sizeof tag, "%d", percent[k]);
        study_must(triangulate(&s, 0, order, removed[k]));
        study_edges(&s.surface.mesh, STUDY_UNIT, tag, edges);
        for (int i = 0; i < POINTS; i++)
            fprintf(pts, "%d,%g,%g,%d\n", percent[k], point[order[i]][0],
                    point[order[i]][1], i < removed[k]);
    }
    for (unsigned f = 0; f < STUDY_FUNCTIONS; f++)
        for (int k = 0; k <= SHARES; k++) {
            char name[32];

            (void)snprintf(name, sizeof name, "fig%u-%d.dat", f + 3, percent[k]);
            study_must(triangulate(&s, f, order, removed[k]));
            study_triangles(study, name, &s.surface.mesh, STUDY_UNIT);
        }
    study_close(edges);
    study_close(pts);
    study_surface_free(&s);
}

void missing_run(const struct study *study)
{
    struct draws d = {.n = study->reduced ? 40 : DRAWS};

    missing_figures(study);
    all_draws(study, &d);
    tables(study, &d);
    for (unsigned f = 0; f < STUDY_FUNCTIONS; f++)
        for (int s = 0; s < SHARES; s++)
            for (int k = 0; k < ERRORS; k++)
                free(d.e[f][s][k]);
}
