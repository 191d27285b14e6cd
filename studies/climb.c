/* climb.c -- hill climbing: how like an enrolled face an attacker's scan becomes whose only help
 * are the scores of a verification, attempt by attempt.  The attacker knows the model: a scan is
 * moved along the model's modes of shape, one after the other, both ways, to the highest point of
 * a parabola through the three scores.  Begun from a stranger's scan or from the mean face; told
 * the score as it is, rounded as for the scope verify alone, or the decision alone.  Beside it how
 * long so many attempts take with the daemon's default lock-out, and how often it has warned. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pose.h"
#include "brute.h"
#include "cloudpoints.h"
#include "face.h"
#include "lab.h"
#include "lockout.h"
#include "model.h"
#include "options.h"
#include "people.h"
#include "scan.h"
#include "study.h"

#define VICTIMS  20
#define ATTEMPTS 1000
#define PEOPLE   40  /* of whom each makes the first attempts on each other */
#define EARLY    30  /* of them */
#define STEP     0.6 /* of a mode, at first */
#define POINTS   (4 * GRID_N)

enum from { STRANGER, MEAN, FROMS };
enum told { EXACT, ROUNDED, DECISION, TOLDS };
static const char *const from_name[] = {"stranger", "mean face"};
static const char *const told_name[] = {"exact", "rounded", "decision"};
static const int shown[] = {1, 2, 3, 5, 10, 14, 30, 100, 300, 1000}; /* attempts */
#define NSHOWN (sizeof shown / sizeof *shown)
static const char columns[] =
    "attempts,victims,matched,low %,high %,median score,highest 5 %,"
    "days with the lock-out,warnings";

struct climb {
    struct face_work *work;
    const struct face *victim;
    enum told told;
    struct dvec3 *base; /* [n], canonical frame; z is without the modes */
    size_t n;
    struct face probe;
    int attempts, refused, most;
    double highest[ATTEMPTS + 1]; /* true score after so many attempts */
    bool matched[ATTEMPTS + 1];
};

/* The height of the modes at a place of the frame. */
static double along(const double *a, double x, double y)
{
    const struct model_basis *b = &model_default.shape;
    const uint32_t cell = grid_cell(x, y);
    double z = 0;

    for (uint32_t k = 0; cell != GRID_NONE && k < b->n; k++)
        z += a[k] * (double)b->mode[cell][k];
    return z;
}

/* One verification: minus what the attacker is told, INFINITY where nothing or the scan is
 * refused.  A refused scan is no attempt. */
static double attempt(struct climb *c, const double *a)
{
    static const struct scan_options lenient = {.axes = SCAN_AXES_AUTO};
    struct cloudpoints p = {.n = c->n, .read = c->n, .unit_mm = 1};
    struct face_result r;
    struct scan_found found;
    double *highest = &c->highest[c->attempts];
    enum status st;

    p.at = mem_array(c->n, sizeof *p.at);
    if (p.at == NULL)
        lab_must(ST_ENOMEM);
    for (size_t i = 0; i < c->n; i++) {
        p.at[i] = c->base[i];
        p.at[i].z += along(a, p.at[i].x, p.at[i].y);
    }
    st = scan_build(&p, &lenient, c->work, &c->probe, NULL, &found);
    cloudpoints_free(&p);
    if (st != ST_OK) {
        c->refused++;
        return INFINITY;
    }
    lab_must(face_compare(c->victim, &c->probe, (double)NAN, NULL, c->work, &r));
    highest[1] = fmax(highest[0], r.score);
    c->matched[c->attempts + 1] = c->matched[c->attempts] || r.decision == FACE_MATCH;
    c->attempts++;
    if (c->told == ROUNDED)
        face_round(&r, c->work);
    return c->told == DECISION ? (r.decision == FACE_MATCH ? 0 : INFINITY) : -r.score;
}

static bool over(const struct climb *c)
{
    return c->attempts >= c->most || c->matched[c->attempts] || c->refused > 4 * c->most;
}

/* The lowest point of the parabola through (-h, low), (0, mid) and (h, high), at most 2 h away;
 * where it has none, the better side. */
static double dip(double h, double low, double mid, double high)
{
    const double bend = low + high - 2 * mid;

    if (isfinite(bend) && bend > 0)
        return fmax(-2 * h, fmin(2 * h, h * (low - high) / (2 * bend)));
    return low < mid ? -h : high < mid ? h : 0;
}

/* Mode by mode, with half the step after each pass; told nothing but decisions, at random. */
static void run(struct climb *c, struct brute_rng *rng)
{
    const uint32_t modes = model_default.shape.n;
    double a[MODEL_MODES] = {0}, h = STEP, here = attempt(c, a);

    for (; c->told == DECISION && !over(c); (void)attempt(c, a))
        for (uint32_t k = 0; k < modes; k++) /* a plausible face */
            a[k] =
                brute_real(rng) + brute_real(rng) + brute_real(rng) + brute_real(rng) - 2;
    for (; !over(c); h /= 2)
        for (uint32_t k = 0; k < modes && !over(c); k++) {
            const double was = a[k];
            double low, high, now;

            a[k] = was - h;
            low = attempt(c, a);
            if (over(c))
                return;
            a[k] = was + h;
            high = attempt(c, a);
            if (over(c))
                return;
            a[k] = was + dip(h, low, here, high);
            now = a[k] == was ? here : attempt(c, a);
            if (now > fmin(here, fmin(low, high))) { /* the best of what was tried */
                a[k] = low < fmin(here, high) ? was - h : high < here ? was + h : was;
                now = fmin(here, fmin(low, high));
            }
            here = now;
        }
}

/* The mean face, a point every half cell. */
static void take_mean(struct climb *c)
{
    c->n = 0;
    for (int j = 0; j < 2 * (GRID_NY - 1); j++)
        for (int i = 0; i < 2 * (GRID_NX - 1); i++) {
            const double u = i % 2 * 0.5, v = j % 2 * 0.5;
            const uint32_t at = (uint32_t)(j / 2 * GRID_NX + i / 2);
            const float *m = &model_default.mean[at];
            const double z =
                (1 - v) * ((1 - u) * (double)m[0] + u * (double)m[1]) +
                v * ((1 - u) * (double)m[GRID_NX] + u * (double)m[GRID_NX + 1]);

            if (!isnan(z))
                c->base[c->n++] =
                    (struct dvec3){grid_x(at) + u * GRID_MM, grid_y(at) + v * GRID_MM, z};
        }
}

/* A stranger's scan, in the canonical frame. */
static void take_stranger(struct climb *c, const struct person *s)
{
    struct face own = {0};

    lab_must(face_build(s->probe, s->n, c->work, &own, NULL));
    c->n = s->n < POINTS ? s->n : POINTS;
    for (size_t i = 0; i < c->n; i++)
        c->base[i] = pose_apply(&own.frame.pose, s->probe[i]);
    face_free(&own);
}

/* How long n attempts take that fail, and how many warnings there are then: one with each
 * lock-out. */
static double locked_out_days(int n, int *warnings)
{
    const unsigned limit = options_default("attempts");
    const unsigned wait_s = options_default("attempt-wait");
    int64_t ms = 0;

    for (int i = 1; i < n; i++)
        ms += lockout_ms(limit, wait_s, OPTIONS_WAIT_MAX, (uint32_t)i);
    *warnings = n < (int)limit ? 0 : n - (int)limit + 1;
    return (double)ms / 86400e3;
}

/* Lines that begin with this. */
static void sum_up(FILE *f, const char *begin, const struct climb *of, size_t n)
{
    double *v = lab_alloc(n, sizeof *v);

    for (size_t s = 0; s < NSHOWN && shown[s] <= of[0].most; s++) {
        size_t matched = 0;
        struct lab_spread spread;
        double low, high, days;
        int warnings;

        for (size_t i = 0; i < n; i++) {
            const int at = shown[s] < of[i].attempts ? shown[s] : of[i].attempts;

            v[i] = of[i].highest[at];
            matched += of[i].matched[at];
        }
        spread = lab_spread(v, n);
        lab_share(matched, n, &low, &high);
        days = locked_out_days(shown[s], &warnings);
        fprintf(f, "%s%d,%zu,%zu,%.2f,%.2f,%.2f,%.2f,%.3g,%d\n", begin, shown[s], n,
                matched, 100 * low, 100 * high, spread.median, spread.high, days,
                warnings);
    }
    fflush(f);
    free(v);
}

static void climb_from(struct climb *c, const struct person *victim,
                       const struct person *stranger, uint64_t seed)
{
    struct brute_rng rng = {seed};

    c->victim = &victim->template;
    c->base = lab_alloc(POINTS, sizeof *c->base);
    c->highest[0] = -INFINITY;
    if (stranger == NULL)
        take_mean(c);
    else
        take_stranger(c, stranger);
    run(c, &rng);
    free(c->base);
    face_free(&c->probe);
}

/* Each from the next person who is no relative, or from the mean face. */
static void climb_far(const struct lab *lab, const struct person *p, size_t n,
                      const size_t *relative, struct face_work *work)
{
    struct climb *c = lab_alloc(n, sizeof *c);
    FILE *f = lab_open(lab, "climb.csv");
    char begin[64];

    fprintf(f, "from,told,%s\n", columns);
    for (enum from from = STRANGER; from < FROMS; from++)
        for (enum told told = EXACT; told < TOLDS; told++) {
            for (size_t i = 0; i < n; i++) {
                size_t next = (i + 1) % n;

                if (relative[i] == next || relative[next] == i)
                    next = (i + 2) % n;
                c[i] = (struct climb){
                    .work = work, .told = told, .most = lab->reduced ? EARLY : ATTEMPTS};
                climb_from(&c[i], &p[i], from == MEAN ? NULL : &p[next], lab->seed + i);
            }
            (void)snprintf(begin, sizeof begin, "%s,%s,", from_name[from],
                           told_name[told]);
            sum_up(f, begin, c, n);
        }
    lab_close(f);
    free(c);
}

/* The first attempts, of which a lock-out leaves some, by each on each. */
static void climb_early(const struct lab *lab, const struct person *p, size_t n,
                        const size_t *relative, struct face_work *work)
{
    struct climb *c = lab_alloc(n * n, sizeof *c);
    FILE *f = lab_open(lab, "early.csv");
    size_t pairs = 0;

    fprintf(f, "%s\n", columns);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            if (i != j && relative[i] != j && relative[j] != i) {
                c[pairs] = (struct climb){.work = work, .told = ROUNDED, .most = EARLY};
                climb_from(&c[pairs++], &p[i], &p[j], lab->seed);
            }
    sum_up(f, "", c, pairs);
    lab_close(f);
    free(c);
}

void climb_run(const struct lab *lab)
{
    const size_t most = lab->reduced ? 3 : PEOPLE;
    struct person *p = lab_alloc(most, sizeof *p);
    size_t *relative = lab_alloc(most, sizeof *relative), n = most;
    struct face_work *work = face_work_new(NULL);

    if (work == NULL)
        lab_must(ST_ENOMEM);
    for (size_t i = 0; i < most; i++)
        relative[i] = i;
    if (lab->faces != NULL) {
        n = people_scanned(lab->faces, "p1", most, work, p);
        (void)people_relatives(lab->faces, p, n, relative);
    } else {
        people_made_up(7010, n, work, p);
    }
    climb_early(lab, p, n, relative, work);
    climb_far(lab, p, n < VICTIMS ? n : VICTIMS, relative, work);
    people_free(p, n);
    free(p);
    free(relative);
    face_work_free(work);
}
