/* minimal.c -- is the minimal disparity that production finds the minimum?  It is compared with
 * the best known one: the least of many descents by values alone (descent.h), from production's
 * own answer, from the alignment and from poses at random round it.  They share nothing with
 * production but the measure itself, measure_at().
 * Allowed are poses within 10 degrees and 20 mm of the alignment (the turn as one rotation, the
 * shift that of the middle of the probe) with 0.95 of the alignment's common area.
 * People: made up (sim/facegen.h), or the scans of a folder, SUBJECT_enroll.ply with
 * SUBJECT_p1.ply to SUBJECT_p4.ply. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pose.h"
#include "descent.h"
#include "face.h"
#include "study.h"
#include "measure.h"
#include "minimal.h"
#include "people.h"
#include "study.h"

#define TURN_MAX  10.0 /* degrees */
#define SHIFT_MAX 20.0 /* mm */
#define AREA_KEPT 0.95

#define DIM    DESCENT_DIM
#define KINDS  4
#define PEOPLE 75 /* times 4 kinds of probe: 300 mated and 300 non-mated pairs */
#define NEXT   7  /* the other person of a non-mated pair; relatives stand side by side */

/* A pair, and its measure as a function of the pose: of descent.h's six numbers. */
struct pair {
    const struct surface_face *tmpl, *probe;
    const double *aligned; /* the alignment's pose */
    struct dvec3 centre;   /* the middle of the probe there */
    double least_area;
    struct measure_work *m;
};

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static struct disparity measure(const struct pair *p, const double x[DIM])
{
    struct disparity d;
    double pose[16];

    descent_pose(p->aligned, p->centre, x, pose);
    study_must(measure_at(&p->tmpl->surface, &p->probe->surface, pose, NULL, p->m, &d));
    return d;
}

static double value(void *arg, const double x[DIM])
{
    const struct pair *p = arg;
    struct disparity d;

    if (descent_angle(x) > TURN_MAX || length(x + 3) > SHIFT_MAX)
        return (double)INFINITY;
    d = measure(p, x);
    return d.area_mm2 < p->least_area || d.area_mm2 == 0 ? (double)INFINITY : d.plain_mm;
}

/* ---- the best known minimum */

#define RANDOM 6 /* starts at random: the last two far away */
#define STARTS (2 + RANDOM)

struct start {
    double x[DIM], f;
    int which; /* 0: production's answer, 1: the alignment */
};

/* Normally distributed, near enough: the sum of twelve. */
static double normal(struct study_random *r)
{
    double sum = -6;

    for (int i = 0; i < 12; i++)
        sum += study_real(r);
    return sum;
}

static int by_value(const void *a, const void *b)
{
    const struct start *x = a, *y = b;

    return (x->f > y->f) - (x->f < y->f);
}

/* brute_force(d, own, r): the best of all starts; own: production's answer. */
static struct start brute_force(struct descent *d, const double own[DIM],
                                struct study_random *r)
{
    struct start s[STARTS];

    for (int i = 0; i < STARTS; i++) {
        const double sd = i < STARTS - 2 ? 2 : 6;

        s[i] = (struct start){.which = i};
        for (int k = 0; k < DIM; k++)
            s[i].x[k] = i == 0 ? own[k] : i == 1 ? 0 : sd * normal(r);
        s[i].f = descent_pattern(d, s[i].x, i < 2 ? 0.5 : sd / 2, 0.25);
    }
    qsort(s, STARTS, sizeof *s, by_value);
    for (int i = 0; i < 2; i++) {
        (void)descent_simplex(d, s[i].x, 0.3, 0.02, 300);
        s[i].f = descent_pattern(d, s[i].x, 0.08, 0.01);
    }
    return s[s[1].f < s[0].f];
}

/* ---- the pairs */

struct record {
    bool mated;
    bool kept; /* production's is the measure at its pose, and keeps the area */
    double aligned, own, best; /* the plain measure, mm */
    double turn, shift, area;  /* of the best, from the alignment; the share kept */
};

struct run {
    const struct study *study;
    struct surface_work *w;
    struct measure_work m;
    uint64_t pairs_done;
    FILE *pairs;
    struct record *record[KINDS]; /* [2 PEOPLE] */
    size_t records[KINDS];
};

static void pose_fields(FILE *f, const double pose[16])
{
    for (int i = 0; i < 12; i++)
        (void)fprintf(f, ",%.9g", pose[i]);
}

static void one_pair(struct run *s, const struct person *template,
                     const struct person *person, const struct surface_face *probe,
                     const char *kind, int k)
{
    struct face_result found;
    struct record *r = &s->record[k][s->records[k]++];
    struct pair p = {.tmpl = &template->template, .probe = probe, .m = &s->m};
    struct descent d = {value, &p, 0};
    struct study_random random = {s->study->seed + s->pairs_done++};
    double own[DIM] = {0}, pose[16];
    struct minimal least;
    struct disparity at;
    struct start best;

    study_must(face_minimal(p.tmpl, probe, NULL, s->w, &found, &least));
    p.aligned = found.align.transform;
    p.centre = vec_transform(p.aligned, pose_centre(&probe->surface.mesh));
    at = measure(&p, own);
    p.least_area = AREA_KEPT * at.area_mm2;
    *r = (struct record){.mated = template == person,
                         .aligned = at.plain_mm,
                         .own = least.disparity.plain_mm};
    study_must(
        measure_at(&p.tmpl->surface, &probe->surface, least.transform, NULL, &s->m, &at));
    r->kept = at.plain_mm == r->own && at.area_mm2 >= p.least_area;
    descent_between(p.aligned, p.centre, least.transform, own);
    best = brute_force(&d, own, &random);
    r->best = fmin(best.f, r->own);
    r->turn = descent_angle(best.x);
    r->shift = length(best.x + 3);
    r->area = AREA_KEPT * measure(&p, best.x).area_mm2 / p.least_area;
    fprintf(s->pairs, "%s,%s,%s,%d,%.6f,%.6f,%.6f,%.5f,%.5f,%.3f,%.3f,%.4f,%u,%d",
            template->name, person->name, kind, r->mated, r->aligned, r->own, r->best,
            r->own / r->best, r->aligned / r->best, r->turn, r->shift, r->area, d.calls,
            best.which);
    pose_fields(s->pairs, p.aligned);
    descent_pose(p.aligned, p.centre, best.x, pose);
    pose_fields(s->pairs, pose);
    fprintf(s->pairs, "\n");
    (void)fflush(s->pairs);
}

/* All pairs of these people: person by person, so that the first lines are of all kinds. */
static void all_pairs(struct run *s, struct person *const p[KINDS], size_t people,
                      const char *const *kind, int kinds)
{
    struct surface_face probe = {0};

    for (size_t i = 0; i < people; i++)
        for (int k = 0; k < kinds; k++) {
            const struct person *const who = &p[k][i], *const other =
                                                           &p[k][(i + NEXT) % people];

            if (face_build(who->probe, who->n, s->w, &probe, NULL) != ST_OK)
                continue; /* (A failure to enrol: no measure either.) */
            one_pair(s, who, who, &probe, kind[k], k);
            one_pair(s, other, who, &probe, kind[k], k);
        }
    face_free(&probe);
}

/* ---- what it comes to */

static double share_below(const double *v, size_t n, double most)
{
    size_t below = 0;

    for (size_t i = 0; i < n; i++)
        below += v[i] <= most;
    return 100.0 * (double)below / (double)n;
}

/* A line for the mated or the non-mated pairs of the kinds from..to - 1; curve: and how many
 * lie below what, or NULL. */
static void line(const struct run *s, const char *name, bool mated, int from, int to,
                 FILE *f, FILE *curve)
{
    enum { OWN, ALIGNED, TURN, SHIFT, AREA, COLUMNS };
    double *v[COLUMNS];
    struct study_spread sp[COLUMNS];
    size_t n = 0, kept = 0;

    for (int c = 0; c < COLUMNS; c++)
        v[c] = study_alloc(2 * PEOPLE * KINDS, sizeof(double));
    for (int k = from; k < to; k++)
        for (size_t i = 0; i < s->records[k]; i++) {
            const struct record *r = &s->record[k][i];

            if (r->mated != mated)
                continue;
            kept += r->kept;
            v[OWN][n] = r->own / r->best;
            v[ALIGNED][n] = r->aligned / r->best;
            v[TURN][n] = r->turn;
            v[SHIFT][n] = r->shift;
            v[AREA][n++] = r->area;
        }
    for (int c = 0; c < COLUMNS && n > 0; c++)
        sp[c] = study_spread(v[c], n);
    if (n > 0)
        fprintf(
            f,
            "%s %s,%zu,%zu,%.1f,%.1f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f,%.2f,%.2f,%.2f,%.2f,"
            "%.3f,%.3f\n",
            mated ? "mated" : "non-mated", name, n, kept, share_below(v[OWN], n, 1.01),
            share_below(v[OWN], n, 1.02), sp[OWN].median, sp[OWN].high, v[OWN][n - 1],
            sp[ALIGNED].median, sp[ALIGNED].high, v[ALIGNED][n - 1], sp[TURN].median,
            v[TURN][n - 1], sp[SHIFT].median, v[SHIFT][n - 1], v[AREA][0],
            v[AREA][n - 1]);
    for (size_t i = 0; curve != NULL && i < n; i++)
        fprintf(curve, "%s,%.4f,%.5f,%.5f\n", mated ? "mated" : "non-mated",
                (double)(i + 1) / (double)n, v[OWN][i], v[ALIGNED][i]);
    for (int c = 0; c < COLUMNS; c++)
        free(v[c]);
}

static void summary(const struct run *s, const char *const *kind, int kinds)
{
    FILE *f = study_open(s->study, "summary.csv"),
         *curve = study_open(s->study, "curve.csv");

    fprintf(
        f,
        "pairs,number,exact at its pose,production within 1 %% of the best known,within 2 %%,"
        "production / best: median,95 %%,the largest,alignment / best: median,"
        "95 %%,the largest,turn from the alignment degrees: median,the largest,"
        "shift mm: median,the largest,common area kept: the least,the largest\n");
    fprintf(curve, "pairs,share,production / best,alignment / best\n");
    for (int mated = 1; mated >= 0; mated--) {
        for (int k = 0; k < kinds && kinds > 1; k++)
            line(s, kind[k], mated, k, k + 1, f, NULL);
        line(s, kinds > 1 ? "all" : kind[0], mated, 0, kinds, f, curve);
    }
    study_close(curve);
    study_close(f);
}

void minimal_run(const struct study *study)
{
    static const char *const scanned[KINDS] = {"p1", "p2", "p3", "p4"};
    static const char *const made_up[1] = {"made up"};
    struct run s = {.study = study, .w = surface_work_new(NULL)};
    const int kinds = study->faces != NULL ? KINDS : 1;
    struct person *p[KINDS];
    size_t people = PEOPLE;

    if (s.w == NULL)
        study_must(ST_ENOMEM);
    if (study->reduced || study->faces == NULL)
        people = study->reduced ? 3 : 30;
    for (int k = 0; k < KINDS; k++) {
        s.record[k] = study_alloc(2 * PEOPLE, sizeof(struct record));
        p[k] = study_alloc(PEOPLE, sizeof *p[k]);
    }
    if (study->faces == NULL)
        people_made_up(900, people, s.w, p[0]);
    for (int k = 0; k < KINDS && study->faces != NULL; k++)
        people = people_scanned(study->faces, scanned[k], people, s.w, p[k]);
    s.pairs = study_open(study, "pairs.csv");
    fprintf(s.pairs, "template,probe,kind,mated,alignment mm,production mm,best known mm,"
                     "production / best,alignment / best,turn degrees,shift mm,"
                     "common area kept,measures,best start");
    for (int i = 0; i < 24; i++)
        fprintf(s.pairs, ",%s %d%d", i < 12 ? "aligned" : "best", i % 12 / 4, i % 4);
    fprintf(s.pairs, "\n");
    all_pairs(&s, p, people, study->faces != NULL ? scanned : made_up, kinds);
    study_close(s.pairs);
    summary(&s, study->faces != NULL ? scanned : made_up, kinds);
    for (int k = 0; k < KINDS; k++) {
        people_free(p[k], PEOPLE);
        free(p[k]);
        free(s.record[k]);
    }
    measure_work_free(&s.m);
    surface_work_free(s.w);
}
