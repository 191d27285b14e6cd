/* method.c -- the disparity-measure paper's figures 1 to 9: walks, a mesh located along its
 * spanning tree, interpolation, the sign cases; and how far the walks go, counted in
 * triangles rather than timed. */
#include <math.h>
#include <stdlib.h>

#include "disparity.h"
#include "study.h"
#include "locate.h"

static size_t scatter(struct study_random *r, size_t n, unsigned f, struct ivec3 *out)
{
    for (size_t i = 0; i < n; i++)
        out[i] = study_lattice(f, study_real(r), study_real(r));
    return n;
}

/* A square's corners first, so that surfaces over it have one hull. */
static size_t scatter_square(struct study_random *r, size_t n, unsigned f,
                             struct ivec3 *out)
{
    for (size_t i = 0; i < 4; i++)
        out[i] = study_lattice(f, (double)(i & 1), (double)(i >> 1));
    return 4 + scatter(r, n - 4, f, out + 4);
}

/* ---- figures 1 to 4 */

struct trail {
    const struct mesh *m;
    FILE *f;
    const char *tag;
    uint64_t entered;
};

static void enter(void *arg, uint32_t t)
{
    struct trail *trail = arg;

    trail->entered++;
    if (trail->f == NULL)
        return;
    for (uint32_t i = 0; i < 4; i++) {
        const struct ivec2 p = trail->m->xy[trail->m->org[3 * t + i % 3]];

        fprintf(trail->f, "%s,%g,%g\n", trail->tag, p.x / STUDY_UNIT, p.y / STUDY_UNIT);
    }
    fprintf(trail->f, "\n");
}

static struct ivec2 middle(const struct mesh *m, uint32_t t)
{
    const struct ivec2 a = m->xy[m->org[3 * t]], b = m->xy[m->org[3 * t + 1]];
    const struct ivec2 c = m->xy[m->org[3 * t + 2]];

    return (struct ivec2){(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
}

static uint32_t nearest(const struct mesh *m, double x, double y)
{
    uint32_t best = 0;
    double least = INFINITY;

    for (uint32_t v = 0; v < m->nv; v++) {
        const double d = hypot(m->xy[v].x - x * STUDY_UNIT, m->xy[v].y - y * STUDY_UNIT);

        if (d < least) {
            least = d;
            best = v;
        }
    }
    return best;
}

static void one_walk(const struct study *study, const struct mesh *m, uint32_t he,
                     struct ivec2 from, struct ivec2 to, const char *name)
{
    char file[64];
    struct trail trail = {m, NULL, "1", 0};
    const struct locate_trace trace = {enter, &trail};
    FILE *f;

    (void)snprintf(file, sizeof file, "%s-path.csv", name);
    trail.f = study_open(study, file);
    (void)locate_point(m, he, from, to, &trace);
    study_close(trail.f);
    (void)snprintf(file, sizeof file, "%s-segment.csv", name);
    f = study_open(study, file);
    fprintf(f, "%g,%g\n%g,%g\n", from.x / STUDY_UNIT, from.y / STUDY_UNIT,
            to.x / STUDY_UNIT, to.y / STUDY_UNIT);
    study_close(f);
    (void)snprintf(file, sizeof file, "%s-edges.csv", name);
    f = study_open(study, file);
    study_edges(m, STUDY_UNIT, "1", f);
    study_close(f);
}

static void walks(const struct study *study)
{
    struct study_random r = {study->seed};
    struct study_surface s = {0};
    struct ivec3 pts[64];
    uint32_t start, through;
    struct ivec2 m, c;

    study_must(study_triangulate(&s, pts, scatter(&r, 64, 0, pts)));
    start = s.surface.mesh.out[nearest(&s.surface.mesh, 0.2, 0.25)];
    m = middle(&s.surface.mesh, start / 3);
    one_walk(study, &s.surface.mesh, start, m, (struct ivec2){8200000, 7600000}, "fig1");
    through = nearest(&s.surface.mesh, 0.5, 0.5);
    c = s.surface.mesh.xy[through];
    one_walk(study, &s.surface.mesh, start, m,
             (struct ivec2){2 * c.x - m.x, 2 * c.y - m.y}, "fig2");
    study_surface_free(&s);
}

static void tree_edges(const struct mesh *m, FILE *f)
{
    for (uint32_t v = 1; v < m->nv; v++)
        fprintf(f, "%g,%g,%g,%g\n", m->xy[v].x / STUDY_UNIT, m->xy[v].y / STUDY_UNIT,
                m->xy[m->parent[v]].x / STUDY_UNIT, m->xy[m->parent[v]].y / STUDY_UNIT);
}

/* walk_tree(in, pts, trail, differ): every vertex of pts from where its parent was found, as
 * locate_mesh() does, counted.  *differ: how many it finds elsewhere. */
static void walk_tree(const struct mesh *in, const struct mesh *pts, struct trail *trail,
                      uint32_t *differ)
{
    const struct locate_trace trace = {enter, trail};
    struct location *loc = study_alloc(pts->nv, sizeof *loc);
    struct location *whole = study_alloc(pts->nv, sizeof *whole);

    locate_mesh(in, pts, whole);
    loc[0] = whole[0];
    *differ = 0;
    for (uint32_t v = 1; v < pts->nv; v++) {
        /* Where the parent lies outside, the walk sets out from the nearest hull edge. */
        const struct location from = loc[pts->parent[v]];
        const struct ivec2 at = from.where == LOCATE_OUTSIDE ? in->xy[in->org[from.he]]
                                                             : pts->xy[pts->parent[v]];

        loc[v] = locate_point(in, from.he, at, pts->xy[v], &trace);
        *differ += loc[v].where != whole[v].where ||
                   (loc[v].where == LOCATE_INSIDE && loc[v].he / 3 != whole[v].he / 3);
    }
    free(loc);
    free(whole);
}

static void trees(const struct study *study)
{
    struct study_random r = {study->seed + 1};
    struct study_surface a = {0}, b = {0};
    struct ivec3 pts[160];
    struct trail trail = {&a.surface.mesh, NULL, "1", 0};
    uint32_t differ;
    FILE *f;

    study_must(study_triangulate(&a, pts, scatter(&r, 160, 0, pts)));
    study_must(study_triangulate(&b, pts, scatter(&r, 60, 0, pts)));
    f = study_open(study, "fig3-edges.csv");
    study_edges(&a.surface.mesh, STUDY_UNIT, "1", f);
    study_close(f);
    f = study_open(study, "fig3-tree.csv");
    tree_edges(&a.surface.mesh, f);
    study_close(f);
    f = study_open(study, "fig4-tree.csv");
    tree_edges(&b.surface.mesh, f);
    study_close(f);
    trail.f = study_open(study, "fig4-path.csv");
    walk_tree(&a.surface.mesh, &b.surface.mesh, &trail, &differ);
    study_close(trail.f);
    study_surface_free(&a);
    study_surface_free(&b);
}

/* How many triangles are entered in locating N points in a mesh of N: along the tree, and
 * each from one place in the middle. */
static void steps(const struct study *study)
{
    static const size_t size[] = {300, 1000, 3000, 10000, 30000, 100000, 300000};
    const size_t sizes = study->reduced ? 4 : sizeof size / sizeof size[0];
    double n[8], along[8], single[8];
    FILE *f = study_open(study, "steps.csv"), *fit = study_open(study, "steps-fit.csv");

    fprintf(f, "points in each mesh,triangles entered along the tree,per point,"
               "found elsewhere than by locate_mesh(),each from the middle: per point\n");
    for (size_t i = 0; i < sizes; i++) {
        struct study_random r = {study->seed + 2};
        struct study_surface a = {0}, b = {0};
        struct ivec3 *pts = study_alloc(size[i], sizeof *pts);
        struct trail trail = {NULL, NULL, "", 0}, far = {NULL, NULL, "", 0};
        const struct locate_trace trace = {enter, &far};
        uint32_t differ, he, tried = 0;

        study_must(study_triangulate(&a, pts, scatter(&r, size[i], 0, pts)));
        study_must(study_triangulate(&b, pts, scatter(&r, size[i], 0, pts)));
        walk_tree(&a.surface.mesh, &b.surface.mesh, &trail, &differ);
        he = a.surface.mesh.out[nearest(&a.surface.mesh, 0.5, 0.5)];
        for (uint32_t v = 0; v < b.surface.mesh.nv;
             v += b.surface.mesh.nv / 300 + 1, tried++)
            (void)locate_point(&a.surface.mesh, he,
                               a.surface.mesh.xy[a.surface.mesh.org[he]],
                               b.surface.mesh.xy[v], &trace);
        n[i] = (double)size[i];
        along[i] = (double)trail.entered;
        single[i] = (double)far.entered / tried;
        fprintf(f, "%zu,%.0f,%.3f,%u,%.2f\n", size[i], along[i], along[i] / n[i], differ,
                single[i]);
        study_surface_free(&a);
        study_surface_free(&b);
        free(pts);
    }
    fprintf(fit, "triangles entered,paper: exponent,exponent,95 %% from,to\n");
    for (int k = 0; k < 2; k++) {
        const struct study_fit e = study_fit(n, k ? single : along, sizes);

        fprintf(fit, "%s,%s,%.3f,%.3f,%.3f\n",
                k ? "one point from the middle" : "a mesh along the tree",
                k ? "0.5" : "1", e.slope, e.slope - e.half, e.slope + e.half);
    }
    study_close(f);
    study_close(fit);
}

/* ---- figures 5 to 8: f2, sampled on the second mesh, on the first one's points */

static void interpolation(const struct study *study)
{
    static const struct {
        int figure;
        size_t n;
        unsigned f1, f2;
    } row[] = {{5, 1000, 3, 0}, {6, 10000, 3, 0}, {7, 10000, 5, 2}, {8, 15000, 5, 2}};
    FILE *f = study_open(study, "interpolation.csv");

    fprintf(f, "figure,points in each mesh,above,below,mean |interpolated - function|,"
               "largest,mean distance of surfaces (2) and (3),largest\n");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        struct study_random r = {study->seed + 3};
        const size_t n = study->reduced ? 1000 : row[i].n;
        struct ivec3 *pts = study_alloc(n, sizeof *pts);
        struct study_surface a = {0}, b = {0}, c = {0};
        struct location *loc;
        double *z, mean = 0, most = 0, apart = 0, widest = 0;
        char name[32];

        study_must(study_triangulate(&a, pts, scatter_square(&r, n, row[i].f1, pts)));
        study_must(study_triangulate(&b, pts, scatter_square(&r, n, row[i].f2, pts)));
        loc = study_alloc(a.surface.mesh.nv, sizeof *loc);
        z = study_alloc(a.surface.mesh.nv, sizeof *z);
        locate_mesh(&b.surface.mesh, &a.surface.mesh, loc);
        locate_heights(&b.surface.mesh, &a.surface.mesh, loc, z);
        for (uint32_t v = 0; v < a.surface.mesh.nv; v++) {
            const struct ivec2 p = a.surface.mesh.xy[v];
            const double off =
                fabs(z[v] / STUDY_UNIT -
                     study_function(row[i].f2, p.x / STUDY_UNIT, p.y / STUDY_UNIT));

            mean += off / a.surface.mesh.nv;
            most = fmax(most, off);
            pts[v] = (struct ivec3){p.x, p.y, (int32_t)lround(z[v])};
        }
        study_must(study_triangulate(&c, pts, a.surface.mesh.nv));
        for (int k = 0; k < 10000; k++) { /* on a grid of 100 x 100 */
            const struct ivec2 q = {(k % 100 * 2 + 1) * 50000, (k / 100 * 2 + 1) * 50000};
            bool inside;
            const double off =
                fabs(study_height(&b, q, &inside) - study_height(&c, q, &inside)) /
                STUDY_UNIT;

            apart += off / 10000;
            widest = fmax(widest, off);
        }
        fprintf(f, "%d,%zu,%s,%s,%.2e,%.2e,%.2e,%.2e\n", row[i].figure, n,
                study_function_name(row[i].f1), study_function_name(row[i].f2), mean,
                most, apart, widest);
        for (int k = 0; k < 3; k++) {
            const struct study_surface *const surface[] = {&a, &b, &c};

            (void)snprintf(name, sizeof name, "fig%d-%d.dat", row[i].figure, k + 1);
            study_triangles(study, name, &surface[k]->surface.mesh, STUDY_UNIT);
        }
        study_surface_free(&a);
        study_surface_free(&b);
        study_surface_free(&c);
        free(loc);
        free(z);
        free(pts);
    }
    study_close(f);
}

/* ---- figure 9: the cases of signs over the triangle (0, 0), (1, 0), (0, 1) */

static void signs(const struct study *study)
{
    /* By hand: the mean of the corners times the area 1/2; where the surfaces cross, the
     * tip on the one side of the line of zeros counted with its sign reversed. */
    static const struct {
        const char *name, *what;
        double a, b, c, hand;
    } row[] = {
        {"a", "a > 0; b > 0; c > 0: prism", 1, 2, 3, 1.0},
        {"b", "a = 0; b > 0; c > 0: quadrangular pyramid", 0, 2, 3, 5.0 / 6},
        {"c", "a = 0; b = 0; c > 0: triangular pyramid", 0, 0, 3, 0.5},
        {"d", "a = 0; b < 0; c > 0: two pyramids", 0, -2, 3, 13.0 / 30},
        {"e", "a > 0; b < 0; c > 0: pyramid and wedge", 1, -2, 3, 23.0 / 45},
    };
    FILE *f = study_open(study, "signs.csv"), *d;

    fprintf(f, "case,signs,a,b,c,by hand,disparity_prism(),difference\n");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const double v = disparity_prism(0.5, row[i].a, row[i].b, row[i].c);
        char name[32];

        fprintf(f, "%s,%s,%g,%g,%g,%.6f,%.6f,%.0e\n", row[i].name, row[i].what, row[i].a,
                row[i].b, row[i].c, row[i].hand, v, fabs(v - row[i].hand));
        (void)snprintf(name, sizeof name, "fig9-%s.dat", row[i].name);
        d = study_open(study, name);
        fprintf(d, "0 0 0\n1 0 0\n\n0 1 0\n0 1 0\n\n\n");
        fprintf(d, "0 0 %g\n1 0 %g\n\n0 1 %g\n0 1 %g\n", row[i].a, row[i].b, row[i].c,
                row[i].c);
        study_close(d);
    }
    /* (f), the wedge alone: (e) less its pyramid, whose base is 2/3 x 2/5 of the triangle
     * and whose height is 2. */
    fprintf(f, "f,the wedge of e,1,-2,3,%.6f,%.6f,%.0e\n", 19.0 / 45,
            disparity_prism(0.5, 1, -2, 3) - disparity_prism(0.5 * 4 / 15, 0, 2, 0),
            fabs(disparity_prism(0.5, 1, -2, 3) - disparity_prism(0.5 * 4 / 15, 0, 2, 0) -
                 19.0 / 45));
    study_close(f);
}

void method_run(const struct study *study)
{
    walks(study);
    trees(study);
    steps(study);
    interpolation(study);
    signs(study);
}
