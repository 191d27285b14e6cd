/* several.c -- several templates: how often a stranger is accepted, and a mated scan not, where the
 * best of n comparisons decides, with the score as it is, lowered by ln n (face_best_of()), and by
 * twice that.  Every probe is compared with every template once; the subject's templates are then
 * taken one by one, in fives, and all together, so that the shares are of the same scans.
 * People: made up, 20 templates each, with smiles of several strengths; of a folder (--faces) each
 * scan against the others, so that a person has five templates at most. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "face.h"
#include "facegen.h"
#include "study.h"
#include "people.h"
#include "study.h"

#define TEMPLATES 20
#define PROBES    3
#define MADE_UP   60  /* people */
#define SCANNED   100 /* at most */

static const int many[] = {1, 5, TEMPLATES};
#define NMANY (sizeof many / sizeof *many)

/* A person's scans; a probe is not compared with itself. */
struct crowd {
    const char *name;
    struct surface_face *face; /* [people * scans] */
    size_t people, scans;
    bool template[TEMPLATES + PROBES], probe[TEMPLATES + PROBES]; /* of a person's */
    size_t *relative;                                             /* [people] */
    float *score; /* [people * scans] [people * scans], NAN: not compared */
};

static float *score_of(const struct crowd *c, size_t probe, size_t template)
{
    return &c->score[probe * c->people * c->scans + template];
}

static void compare(struct crowd *c, struct surface_work *w)
{
    const size_t n = c->people * c->scans;

    c->score = study_alloc(n * n, sizeof *c->score);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            const size_t a = i / c->scans, b = k / c->scans;
            struct face_result r;

            *score_of(c, i, k) = NAN;
            if (i == k || !c->probe[i % c->scans] || !c->template[k % c->scans] ||
                c->face[i].surface.mesh.nv == 0 || c->face[k].surface.mesh.nv == 0 ||
                (a != b && (c->relative[a] == b || c->relative[b] == a)))
                continue;
            study_must(face_compare(&c->face[k], &c->face[i], (double)NAN, NULL, w, &r));
            *score_of(c, i, k) = (float)r.score;
        }
}

/* ---- the best of n */

struct scores {
    double *best[2]; /* of non-mated comparisons, and of mated ones */
    size_t n[2];
};

/* The templates of a person, without the probe itself, in groups of n; a rest is left out. */
static void add_groups(const struct crowd *c, size_t probe, size_t person, int n,
                       struct scores *s)
{
    const int mated = probe / c->scans == person;
    double best = -(double)INFINITY;
    int got = 0;

    for (size_t k = 0; k < c->scans; k++) {
        const float score = *score_of(c, probe, person * c->scans + k);

        if (isnan(score))
            continue;
        best = fmax(best, (double)score);
        if (++got < n)
            continue;
        s->best[mated][s->n[mated]++] = best;
        best = -(double)INFINITY;
        got = 0;
    }
}

static void gather(const struct crowd *c, int n, struct scores *s)
{
    const size_t all = c->people * c->scans;

    for (int m = 0; m < 2; m++) {
        s->best[m] = study_alloc(all * all, sizeof *s->best[m]);
        s->n[m] = 0;
    }
    for (size_t i = 0; i < all; i++)
        for (size_t p = 0; p < c->people; p++)
            add_groups(c, i, p, n, s);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* How many of v[n], which ascends, are at or above a threshold. */
static size_t at_least(const double *v, size_t n, double threshold)
{
    size_t low = 0, high = n;

    while (low < high) {
        const size_t mid = low + (high - low) / 2;

        if (v[mid] >= threshold)
            high = mid;
        else
            low = mid + 1;
    }
    return n - low;
}

static double percent(size_t k, size_t n)
{
    return n > 0 ? 100.0 * (double)k / (double)n : (double)NAN;
}

/* ---- what is written */

/* At a threshold: of the best as it is, less ln n, and less twice that. */
static void write_at(FILE *f, const struct crowd *c, const struct scores *s, int n,
                     double threshold)
{
    double low, high;

    fprintf(f, "%s,%d", c->name, n);
    study_field(f, 2, threshold);
    fprintf(f, ",%zu,%zu", s->n[0], s->n[1]);
    for (int k = 0; k < 3; k++) {
        const double t = threshold + k * log(n);
        const size_t matched = at_least(s->best[0], s->n[0], t);

        study_field(f, 4, percent(matched, s->n[0]));
        study_share(matched, s->n[0], &low, &high);
        study_field(f, 4, 100 * high);
        study_field(f, 2, percent(s->n[1] - at_least(s->best[1], s->n[1], t), s->n[1]));
    }
    (void)fputc('\n', f);
}

/* The thresholds at which single comparisons have these false match rates, and the model's. */
static void write_crowd(const struct crowd *c, double own, FILE *f, FILE *curve)
{
    static const double rate[] = {0.01, 0.001, 0.0001};
    struct scores s[NMANY];
    double threshold[5] = {own};

    for (size_t i = 0; i < NMANY; i++) {
        gather(c, many[i], &s[i]);
        for (int m = 0; m < 2; m++)
            qsort(s[i].best[m], s[i].n[m], sizeof *s[i].best[m], ascending);
    }
    for (int k = 0; k < 3; k++) {
        const size_t most = (size_t)(rate[k] * (double)s[0].n[0]);

        threshold[k + 1] =
            most > 0 ? s[0].best[0][s[0].n[0] - most] : (double)NAN; /* too few */
    }
    for (int k = 0; k < 4; k++)
        for (size_t i = 0; i < NMANY; i++)
            if (s[i].n[0] > 0 && !isnan(threshold[k]))
                write_at(f, c, &s[i], many[i], threshold[k]);
    for (size_t i = 0; i < NMANY; i++) {
        for (double t = threshold[1] - 5; s[i].n[0] > 0 && t < threshold[1] + 40;
             t += 0.5)
            write_at(curve, c, &s[i], many[i], t);
        free(s[i].best[0]);
        free(s[i].best[1]);
    }
}

static void end_crowd(struct crowd *c)
{
    for (size_t i = 0; i < c->people * c->scans; i++)
        face_free(&c->face[i]);
    free(c->face);
    free(c->relative);
    free(c->score);
}

/* ---- people */

static void made_up(const struct study *study, struct surface_work *w, struct crowd *c)
{
    struct dvec3 *pts = study_alloc(PEOPLE_POINTS, sizeof *pts);

    *c = (struct crowd){.name = "made up",
                        .people = study->reduced ? 5 : MADE_UP,
                        .scans = TEMPLATES + PROBES};
    c->face = study_alloc(c->people * c->scans, sizeof *c->face);
    c->relative = study_alloc(c->people, sizeof *c->relative);
    for (size_t k = 0; k < c->scans; k++)
        *(k < TEMPLATES ? &c->template[k] : &c->probe[k]) = true;
    for (size_t i = 0; i < c->people * c->scans; i++) {
        const size_t k = i % c->scans;
        struct facegen_scan scan;

        c->relative[i / c->scans] = i / c->scans;
        facegen_default(&scan);
        scan.subject = study->seed + i / c->scans;
        scan.scan = k;
        scan.noise = k < TEMPLATES ? 0.15 : 0.3;
        scan.warp = 0.4;
        scan.smile = (double)(k % 5) / 4;
        facegen_pose(&scan, k < TEMPLATES ? 3 : 8, 10);
        study_must(face_build(pts, facegen_sample(&scan, pts), w, &c->face[i], NULL));
    }
    free(pts);
}

static void scanned(const struct study *study, struct surface_work *w, struct crowd *c)
{
    static const char *const kind[] = {"enroll", "p1", "p2", "p3", "p3b", "p4"};
    const size_t most = study->reduced ? 5 : SCANNED;
    struct person *p = study_alloc(most, sizeof *p);

    *c = (struct crowd){.name = "scans", .scans = sizeof kind / sizeof *kind};
    c->people = people_scanned(study->faces, "p1", most, w, p);
    c->face = study_alloc(c->people * c->scans, sizeof *c->face);
    c->relative = study_alloc(c->people, sizeof *c->relative);
    (void)people_relatives(study->faces, p, c->people, c->relative);
    for (size_t k = 0; k < c->scans; k++)
        c->probe[k] = c->template[k] = true;
    for (size_t i = 0; i < c->people * c->scans; i++) {
        char name[64];
        size_t n = 0;
        struct dvec3 *pts;

        (void)snprintf(name, sizeof name, "%s_%s.ply", p[i / c->scans].name,
                       kind[i % c->scans]);
        pts = people_points(study->faces, name, &n);
        if (pts != NULL)
            (void)face_build(pts, n, w, &c->face[i], NULL); /* refused: empty */
        free(pts);
    }
    people_free(p, c->people);
    free(p);
}

void several_run(const struct study *study)
{
    static const char columns[] =
        "people,templates,threshold,non-mated,mated,as it is: FMR %,below %,FNMR %,"
        "less ln n: FMR %,below %,FNMR %,less 2 ln n: FMR %,below %,FNMR %\n";
    struct surface_work *w = surface_work_new(NULL);
    FILE *f = study_open(study, "several.csv"), *curve = study_open(study, "curve.csv");
    const double own = model_default.calibration.threshold;
    struct crowd c;

    fputs(columns, f);
    fputs(columns, curve);
    made_up(study, w, &c);
    compare(&c, w);
    write_crowd(&c, own, f, curve);
    end_crowd(&c);
    if (study->faces != NULL) {
        scanned(study, w, &c);
        compare(&c, w);
        write_crowd(&c, own, f, curve);
        end_crowd(&c);
    }
    study_close(f);
    study_close(curve);
    surface_work_free(w);
}
