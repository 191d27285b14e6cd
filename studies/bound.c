/* bound.c -- how far below the minimal disparity that production reports could the true minimum
 * lie?  A sound lower bound over a box of poses round it, of the measure with its domain frozen
 * there (frozen.h says what is proved, and for what), by branch and bound: the box with the
 * least bound is cut in two until so many boxes were bounded.
 * How far the frozen measure is the measure, random poses tell; that is no proof. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pose.h"
#include "brute.h"
#include "descent.h"
#include "face.h"
#include "frozen.h"
#include "lab.h"
#include "measure.h"
#include "minimal.h"
#include "people.h"
#include "study.h"

#define DIM   DESCENT_DIM
#define KINDS 4
#define MATED 5 /* pairs, and as many non-mated ones */
#define NEXT  7

/* Boxes of poses: every shift and turn (80 mm a radian) up to so many mm.  The last one holds
 * all that is allowed round the alignment, 10 degrees and 20 mm, wherever in it the minimum
 * was found. */
static const double radius[] = {0.25, 0.5, 1, 2, 5, 24};
#define RADII (sizeof radius / sizeof radius[0])

struct study {
    const struct lab *lab;
    struct face_work *w;
    struct measure_work m;
    struct brute_rng random;
    FILE *bounds, *steps, *check, *sampled;
    int pairs;
    double ratio[2 * MATED][RADII]; /* the bound over the reported minimum */
    bool mated[2 * MATED];
};

/* A pair at its reported minimum. */
struct pair {
    const struct face *tmpl, *probe;
    struct minimal least;
    struct frozen *frozen;
    char name[80]; /* three fields of a table */
};

/* ---- branch and bound */

#define BOXES 1001 /* a bound is taken from; the first pair's from more */
#define DEEP  16
#define GOAL  0.98 /* of the reported minimum: enough */

struct heap {
    struct frozen_box *box; /* [n], the least bound first */
    size_t n;
};

static void push(struct heap *h, const struct frozen_box *b)
{
    size_t i = h->n++;

    for (; i > 0 && h->box[(i - 1) / 2].least > b->least; i = (i - 1) / 2)
        h->box[i] = h->box[(i - 1) / 2];
    h->box[i] = *b;
}

static struct frozen_box pop(struct heap *h)
{
    const struct frozen_box first = h->box[0], last = h->box[--h->n];
    size_t i = 0, child;

    for (; (child = 2 * i + 1) < h->n; i = child) {
        child += child + 1 < h->n && h->box[child + 1].least < h->box[child].least;
        if (last.least <= h->box[child].least)
            break;
        h->box[i] = h->box[child];
    }
    h->box[i] = last;
    return first;
}

/* Halves of the box that is lowest. */
static void cut(struct frozen *f, struct heap *h)
{
    const struct frozen_box whole = pop(h);

    for (int side = -1; side <= 1; side += 2) {
        struct frozen_box b = whole;

        b.h[b.widest] /= 2;
        b.c[b.widest] += side * b.h[b.widest];
        frozen_bound(f, &b);
        b.least = fmax(b.least, whole.least);
        push(h, &b);
    }
}

static void by_radius(struct study *s, const struct pair *p, size_t most)
{
    struct heap h = {lab_alloc(most + 2, sizeof(struct frozen_box)), 0};
    const double reported = p->least.disparity.plain_mm;

    for (size_t k = 0; k < RADII; k++) {
        struct frozen_box whole = {{0}, {0}, 0, {0}, 0};
        size_t boxes = 1, told = 1;

        for (int i = 0; i < DIM; i++)
            whole.h[i] = radius[k];
        frozen_bound(p->frozen, &whole);
        h.n = 0;
        push(&h, &whole);
        for (; boxes < most && h.box[0].least < GOAL * reported; boxes += 2) {
            if (boxes >= told) {
                fprintf(s->steps, "%s,%g,%zu,%.5f\n", p->name, radius[k], boxes,
                        h.box[0].least / reported);
                told *= 2;
            }
            cut(p->frozen, &h);
        }
        fprintf(s->steps, "%s,%g,%zu,%.5f\n", p->name, radius[k], boxes,
                h.box[0].least / reported);
        s->ratio[s->pairs][k] = h.box[0].least / reported;
        fprintf(s->bounds, "%s,%.6f,%g,%.2f,%zu,%.6f,%.5f", p->name, reported, radius[k],
                radius[k] / DESCENT_LEVER * 180 / acos(-1.0), boxes, h.box[0].least,
                s->ratio[s->pairs][k]);
        for (int i = 0; i < DIM; i++)
            fprintf(s->bounds, ",%.4f", h.box[0].h[i]);
        fprintf(s->bounds, "\n");
    }
    free(h.box);
}

/* ---- checks by random poses */

static double frozen_at(void *arg, const double x[DIM])
{
    return frozen_value(arg, x);
}

/* Boxes of all sizes, poses of each: is F below the bound anywhere?  And below the bound of
 * half the box?  It has to be somewhere, or these poses would find nothing. */
static void check(struct study *s, const struct pair *p, int boxes)
{
    struct brute_rng *const r = &s->random;
    struct descent d = {frozen_at, p->frozen, 0};
    double zero[DIM] = {0}, lowest[DIM] = {0}, closest = (double)INFINITY, at_zero, least;
    int poses = 0, below = 0, below_half = 0;
    struct disparity there;
    size_t outside = 0;
    double pose[16];

    for (int i = 0; i < boxes; i++) {
        const double size = 0.03 * pow(100, brute_real(r));
        const double off = 0.1 * pow(100, brute_real(r));
        struct frozen_box b = {{0}, {0}, 0, {0}, 0}, half;

        for (int k = 0; k < DIM; k++) {
            b.c[k] = off * (2 * brute_real(r) - 1);
            b.h[k] = size * brute_real(r);
        }
        half = b;
        for (int k = 0; k < DIM; k++)
            half.h[k] /= 2;
        frozen_bound(p->frozen, &b);
        frozen_bound(p->frozen, &half);
        for (int j = 0; j < 10; j++) { /* the lowest pose, corners, poses inside */
            double x[DIM], f;

            for (int k = 0; k < DIM; k++)
                x[k] = j == 0 ? b.low[k]
                              : b.c[k] + b.h[k] * (j > 5 ? 2 * brute_real(r) - 1
                                                   : brute_rand(r) & 1 ? 1
                                                                       : -1);
            f = frozen_value(p->frozen, x);
            poses++;
            if (j < 2)
                outside += frozen_outside(p->frozen, &b, x);
            below += f < b.least;
            below_half += f < half.least;
            closest = fmin(closest, b.least > 0 ? f / b.least : (double)INFINITY);
        }
    }
    at_zero = frozen_value(p->frozen, zero);
    least = descent_pattern(&d, lowest, 0.5, 0.01);
    descent_pose(p->least.transform, frozen_centre(p->frozen), lowest, pose);
    lab_must(
        measure_at(&p->tmpl->surface, &p->probe->surface, pose, NULL, &s->m, &there));
    fprintf(s->check, "%s,%.9f,%.9f,%.5f,%.5f,%d,%d,%d,%.5f,%d,%zu\n", p->name,
            p->least.disparity.plain_mm, at_zero, least / at_zero,
            there.plain_mm / at_zero, boxes, poses, below, closest, below_half, outside);
}

/* The measure itself and the frozen one at random poses. */
static void sample(struct study *s, const struct pair *p, size_t poses)
{
    const double reported = p->least.disparity.plain_mm;
    double *const over = lab_alloc(poses, sizeof *over);

    for (size_t k = 0; k < RADII; k++) {
        double least_frozen = (double)INFINITY, least = (double)INFINITY;
        struct lab_spread sp;

        for (size_t i = 0; i < poses; i++) {
            struct disparity d;
            double x[DIM], pose[16], f;

            for (int j = 0; j < DIM; j++)
                x[j] = radius[k] * (2 * brute_real(&s->random) - 1);
            descent_pose(p->least.transform, frozen_centre(p->frozen), x, pose);
            lab_must(
                measure_at(&p->tmpl->surface, &p->probe->surface, pose, NULL, &s->m, &d));
            f = frozen_value(p->frozen, x);
            over[i] = d.plain_mm / f;
            least_frozen = fmin(least_frozen, f / reported);
            least = fmin(least, d.plain_mm / reported);
        }
        sp = lab_spread(over, poses);
        fprintf(s->sampled, "%s,%g,%zu,%.4f,%.4f,%.4f,%.4f,%.4f\n", p->name, radius[k],
                poses, least_frozen, least, over[0], sp.median, over[poses - 1]);
    }
    free(over);
}

static void one_pair(struct study *s, const struct person *template,
                     const struct person *person, const char *kind)
{
    const bool reduced = s->lab->reduced;
    struct pair p = {.tmpl = &template->template};
    struct face probe = {0};
    struct face_result found;
    struct disparity d;

    lab_must(face_build(person->probe, person->n, s->w, &probe, NULL));
    p.probe = &probe;
    lab_must(face_minimal(p.tmpl, &probe, NULL, s->w, &found, &p.least));
    lab_must(
        measure_at(&p.tmpl->surface, &probe.surface, p.least.transform, NULL, &s->m, &d));
    p.frozen = frozen_new(p.tmpl, &s->m);
    (void)snprintf(p.name, sizeof p.name, "%s,%s,%s", template->name, person->name, kind);
    s->mated[s->pairs] = template == person;
    s->random.state = s->lab->seed + (uint64_t)s->pairs;
    by_radius(s, &p, reduced ? 101 : s->pairs == 0 ? (size_t)DEEP * BOXES : BOXES);
    check(s, &p, reduced ? 40 : 60);
    sample(s, &p, reduced ? 10 : 60);
    s->pairs++;
    frozen_free(p.frozen);
    face_free(&probe);
}

/* ---- what it comes to */

static void summary(const struct study *s)
{
    FILE *f = lab_open(s->lab, "summary.csv");

    fprintf(
        f, "within mm and 1/80 rad,mated: bound / reported: the least,median,the largest,"
           "non-mated: the least,median,the largest\n");
    for (size_t k = 0; k < RADII; k++) {
        fprintf(f, "%g", radius[k]);
        for (int mated = 1; mated >= 0; mated--) {
            double v[2 * MATED];
            size_t n = 0;

            for (int i = 0; i < s->pairs; i++)
                if (s->mated[i] == mated)
                    v[n++] = s->ratio[i][k];
            fprintf(f, ",%.4f,%.4f,%.4f", v[0], lab_spread(v, n).median, v[n - 1]);
        }
        fprintf(f, "\n");
    }
    lab_close(f);
}

static void open_tables(struct study *s)
{
    s->bounds = lab_open(s->lab, "bounds.csv");
    fprintf(s->bounds,
            "template,probe,kind,reported mm,within mm,within degrees,boxes,bound mm,"
            "bound / reported,half side of the lowest box mm: turn x,turn y,turn z,"
            "shift x,shift y,shift z\n");
    s->steps = lab_open(s->lab, "steps.csv");
    fprintf(s->steps, "template,probe,kind,within mm,boxes,bound / reported\n");
    s->check = lab_open(s->lab, "check.csv");
    fprintf(
        s->check,
        "template,probe,kind,reported mm,frozen measure there mm,"
        "its least value found / that,the measure at that pose / that,random boxes,poses,below the bound,"
        "value / bound: the least,below the bound of half the box,"
        "gaps of corners outside their bounds\n");
    s->sampled = lab_open(s->lab, "sampled.csv");
    fprintf(s->sampled, "template,probe,kind,within mm,random poses,"
                        "frozen / reported: the least,measure / reported: the least,"
                        "measure / frozen: the least,median,the largest\n");
}

/* The pairs: mated ones of all kinds of probe, then non-mated ones of further people. */
static void all_pairs(struct study *s, struct person *const p[KINDS],
                      const char *const kind[KINDS], size_t people)
{
    const size_t mated = s->lab->reduced ? 1 : MATED;

    for (size_t i = 0; i < 2 * mated; i++) {
        const size_t k = i % mated % KINDS;

        one_pair(s, &p[k][i < mated ? i : (i + NEXT) % people], &p[k][i], kind[k]);
    }
}

void bound_run(const struct lab *lab)
{
    static const char *const scanned[KINDS] = {"p1", "p2", "p3", "p4"};
    static const char *const made_up[KINDS] = {"made up", "made up", "made up",
                                               "made up"};
    struct study s = {.lab = lab, .w = face_work_new(NULL)};
    const size_t people = 2 * MATED;
    struct person *p[KINDS];

    if (s.w == NULL)
        lab_must(ST_ENOMEM);
    for (int k = 0; k < KINDS; k++) {
        p[k] = lab_alloc(people, sizeof *p[k]);
        if (lab->faces == NULL)
            people_made_up(950, people, s.w, p[k]);
        else if (people_scanned(lab->faces, scanned[k], people, s.w, p[k]) < people)
            lab_must(ST_ENOTFOUND);
    }
    open_tables(&s);
    all_pairs(&s, p, lab->faces != NULL ? scanned : made_up, people);
    lab_close(s.bounds);
    lab_close(s.steps);
    lab_close(s.check);
    lab_close(s.sampled);
    summary(&s);
    for (int k = 0; k < KINDS; k++) {
        people_free(p[k], people);
        free(p[k]);
    }
    measure_work_free(&s.m);
    face_work_free(s.w);
}
