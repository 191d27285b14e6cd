/* filled.c -- how far restored points (core/measure/fill.h) are from the true face, by the size of the
 * hole: round and long holes cut out of made-up scans, and out of a folder's, if one is given;
 * there the points that were cut out stand for the truth. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brute.h"
#include "facegen.h"
#include "fill.h"
#include "lab.h"
#include "lattice.h"
#include "people.h"
#include "study.h"

#define MOST   60000 /* points of a scan */
#define PEOPLE 200
#define CUTS   4 /* draws of a hole in one scan, one after the other */
#define SIZES  FILL_SIZES

static const double size_mm[SIZES] = FILL_SIZE_MM;

struct errors {
    double *v; /* |restored - true|, mm */
    size_t n, room, holes;
    double squares, diameters;
};

struct cut {
    double x, y, along, across, turn; /* an ellipse: centre, half axes, mm, radians */
};

static struct cut draw(struct brute_rng *r, double aspect)
{
    const double low = size_mm[0] / 1.2, high = size_mm[SIZES - 1] * 1.2;
    const double half = 0.5 * low * pow(high / low, brute_real(r));
    const double x = 90 * brute_real(r) - 45, y = 110 * brute_real(r) - 60;

    return (struct cut){x, y, half * sqrt(aspect), half / sqrt(aspect),
                        3.141592653589793 * brute_real(r)};
}

static bool inside(const struct cut *c, double x, double y)
{
    const double u = (x - c->x) * cos(c->turn) + (y - c->y) * sin(c->turn);
    const double v = (y - c->y) * cos(c->turn) - (x - c->x) * sin(c->turn);

    return u * u / (c->along * c->along) + v * v / (c->across * c->across) < 1;
}

static void add(struct errors *e, double off)
{
    if (e->n == e->room) {
        e->room = 2 * e->room + 1024;
        if ((e->v = realloc(e->v, e->room * sizeof *e->v)) == NULL)
            lab_must(ST_ENOMEM);
    }
    e->v[e->n++] = fabs(off);
    e->squares += off * off;
}

/* Which size a diameter is nearest to, by its ratio; SIZES: none. */
static int size_of(double mm)
{
    for (int k = 0; k < SIZES; k++)
        if (fabs(log(mm / size_mm[k])) <
            0.5 * log(size_mm[SIZES - 1] / size_mm[SIZES - 2]))
            return k;
    return SIZES;
}

struct work {
    struct dvec3 *whole, *left;
    struct ivec3 *lattice;
    struct lab_surface cut, uncut;
    struct fill fill;
};

/* Cut c out of the n points, fill, and add the errors to those of the hole's size.  Truth:
 * the face, or where face is NULL the surface of the whole scan. */
static void measure(struct work *w, size_t n, const struct cut *c,
                    const struct facegen_face *face, struct errors e[SIZES])
{
    struct fill *f = &w->fill;
    size_t left = 0;

    for (size_t i = 0; i < n; i++)
        if (!inside(c, w->whole[i].x, w->whole[i].y))
            w->left[left++] = w->whole[i];
    lab_must(lattice_from_mm(w->left, left, LATTICE_PER_MM, w->lattice, NULL));
    if (lab_triangulate(&w->cut, w->lattice, left) != ST_OK)
        return;
    lab_must(fill_holes(&w->cut.surface, 1000000, &w->cut.scratch, f));
    for (uint32_t i = 0, p = 0; i < f->nholes; p += f->hole[i++].points) {
        const int k = size_of(f->hole[i].diameter / LATTICE_PER_MM);
        const struct ivec3 middle = f->pts[p + f->hole[i].points / 2];

        if (k == SIZES ||
            !inside(c, middle.x / LATTICE_PER_MM, middle.y / LATTICE_PER_MM))
            continue; /* a gap that was there before */
        e[k].holes++;
        e[k].diameters += f->hole[i].diameter / LATTICE_PER_MM;
        for (uint32_t j = p; j < p + f->hole[i].points; j++) {
            const struct ivec3 q = f->pts[j];
            bool within = true;
            const double z =
                face != NULL ? LATTICE_PER_MM * facegen_height(face, q.x / LATTICE_PER_MM,
                                                               q.y / LATTICE_PER_MM)
                             : lab_height(&w->uncut, (struct ivec2){q.x, q.y}, &within);

            add(&e[k], (q.z - z) / LATTICE_PER_MM);
        }
    }
}

static void report(FILE *f, const char *what, struct errors e[SIZES])
{
    for (int k = 0; k < SIZES; k++) {
        struct lab_spread s = {NAN, NAN, NAN, NAN};

        if (e[k].n > 0)
            s = lab_spread(e[k].v, e[k].n);
        fprintf(f, "%s,%.0f,%zu,%zu", what, size_mm[k], e[k].holes, e[k].n);
        lab_field(f, 1, e[k].diameters / (double)e[k].holes);
        lab_field(f, 2, sqrt(e[k].squares / (double)e[k].n));
        lab_field(f, 2, s.median);
        lab_field(f, 2, s.high);
        fputc('\n', f);
        free(e[k].v);
    }
}

static void made_up(const struct lab *lab, FILE *f, struct work *w, const char *what,
                    uint32_t points, double aspect)
{
    const uint64_t people = lab->reduced ? 30 : points > 3000 ? 100 : 400;
    struct errors e[SIZES] = {{0}};
    struct brute_rng r = {lab->seed};

    for (uint64_t s = 0; s < people; s++) {
        struct facegen_scan scan;
        struct facegen_face face;
        size_t n;

        facegen_default(&scan);
        scan.subject = s;
        scan.points = points;
        facegen_face(s, 0, &face);
        n = facegen_sample(&scan, w->whole);
        for (int i = 0; i < CUTS; i++) {
            const struct cut c = draw(&r, aspect);

            measure(w, n, &c, &face, e);
        }
    }
    report(f, what, e);
}

/* What is taken for a hole in scans from which nothing was cut out. */
static void gaps(const struct lab *lab, FILE *f, struct work *w, uint32_t points)
{
    const uint64_t people = lab->reduced ? 10 : 200;
    double holes = 0, restored = 0;

    for (uint64_t s = 0; s < people; s++) {
        struct facegen_scan scan;
        size_t n;

        facegen_default(&scan);
        scan.subject = s;
        scan.points = points;
        n = facegen_sample(&scan, w->whole);
        lab_must(lattice_from_mm(w->whole, n, LATTICE_PER_MM, w->lattice, NULL));
        lab_must(lab_triangulate(&w->uncut, w->lattice, n));
        lab_must(fill_holes(&w->uncut.surface, 1000000, &w->uncut.scratch, &w->fill));
        holes += w->fill.nholes;
        restored += w->fill.n;
    }
    fprintf(f, "%u,%.2f,%.1f\n", points, holes / (double)people,
            restored / (double)people);
}

/* The surface of a whole scan is the truth for what is cut out of it, noise included. */
static void scanned(const struct lab *lab, FILE *f, struct work *w, double aspect)
{
    struct face_work *faces = face_work_new(NULL);
    struct person *people = lab_alloc(PEOPLE, sizeof *people);
    struct errors e[SIZES] = {{0}};
    struct brute_rng r = {lab->seed};
    size_t n;

    if (faces == NULL)
        lab_must(ST_ENOMEM);
    n = people_scanned(lab->faces, "p1", PEOPLE, faces, people);
    for (size_t s = 0; s < n; s++) {
        if (people[s].n > MOST)
            continue;
        memcpy(w->whole, people[s].probe, people[s].n * sizeof *w->whole);
        lab_must(
            lattice_from_mm(w->whole, people[s].n, LATTICE_PER_MM, w->lattice, NULL));
        lab_must(lab_triangulate(&w->uncut, w->lattice, people[s].n));
        for (int i = 0; i < CUTS; i++) {
            const struct cut c = draw(&r, aspect);

            measure(w, people[s].n, &c, NULL, e);
        }
    }
    report(f, aspect > 1 ? "scans of a folder; 4 : 1" : "scans of a folder; round", e);
    people_free(people, n);
    free(people);
    face_work_free(faces);
}

void filled_run(const struct lab *lab)
{
    struct work w = {.whole = lab_alloc(MOST, sizeof *w.whole),
                     .left = lab_alloc(MOST, sizeof *w.left),
                     .lattice = lab_alloc(MOST, sizeof *w.lattice)};
    FILE *f = lab_open(lab, "filled.csv"), *g = lab_open(lab, "gaps.csv");

    fprintf(f, "scans and holes,size mm,holes,points restored,mean diameter mm,"
               "error: root mean square mm,median,95 %%\n");
    made_up(lab, f, &w, "3000 points; round", 3000, 1);
    made_up(lab, f, &w, "20000 points; round", 20000, 1);
    made_up(lab, f, &w, "3000 points; 4 : 1", 3000, 4);
    if (lab->faces != NULL) {
        scanned(lab, f, &w, 1);
        scanned(lab, f, &w, 4);
    }
    fprintf(g, "points,holes a scan,points restored a scan\n");
    gaps(lab, g, &w, 3000);
    gaps(lab, g, &w, 20000);
    lab_close(f);
    lab_close(g);
    fill_free(&w.fill);
    lab_surface_free(&w.cut);
    lab_surface_free(&w.uncut);
    free(w.whole);
    free(w.left);
    free(w.lattice);
}
