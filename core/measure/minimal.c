#include "minimal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "measure.h"
#include "minimal_places.h"

/* tan(MINIMAL_TURN_DEG / 2). */
#define MINIMAL_TAN_HALF_TURN 0.08748866352592400

/* The number of the first steps; a seventh gains nothing.  The length, mm, of a step that is the last one. */
#define MINIMAL_STEPS    6
#define MINIMAL_SHORT_MM 0.1

/* The longest Newton step, mm, in the first steps and in the last.  Chosen empirically. */
#define MINIMAL_FAR_MM  4
#define MINIMAL_LAST_MM 1

/* Samplings of all vertices, at most; and the length of the last step, mm, that asks for another
 * one: one pair in 18.  Non-mated pairs more than 2 % above the least known value
 * become 0.7 % instead of 1.0; with 0.35 mm no fewer. */
#define MINIMAL_LOOKS   3
#define MINIMAL_NEAR_MM 1

/* The mean gap, mm, below which nothing is minimised: a tenth of a lattice unit. */
#define MINIMAL_LEVEL_MM 1e-4

/* The alignment is measured too unless estimate and measure are less than this share of the
 * estimate at the alignment, and the estimated area is not less than this share of the one
 * there.  Of 600 pairs the change of the estimate errs by -5 to +17 % of the measure's, of the
 * area by 2 %; one pair in 20 is measured at both poses. */
#define MINIMAL_SURE_GAP  0.95
#define MINIMAL_SURE_AREA 0.97

/* The least share of the motion that is tried if all of it is not allowed.  Chosen empirically. */
#define MINIMAL_LEAST_SHARE 0.1

/* A search in progress. */
struct minimal_search {
    struct minimal_pair pair;
    const double *transform; /* the alignment */
    struct pose aligned;     /* the same as a pose */
    double x[6];             /* the motion found, from the alignment */
    struct measure_work *w;
};

/* An estimate of the measure, from few of the probe's vertices. */
struct estimate {
    double gap;  /* mean of |gap|, mm */
    double area; /* common to both */
};

static struct pose pose_at(const struct minimal_search *s, const double x[6])
{
    struct pose pose = s->aligned;

    pose_move(&pose, s->pair.centre, x);
    return pose;
}

/* Shortens v[0..2] to at most `most`. */
static void shorten(double v[3], double most)
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

    for (int k = 0; k < 3 && length > most; k++)
        v[k] *= most / length;
}

/* The motion y more, but no farther than allowed. */
static void move(struct minimal_search *s, const double y[6])
{
    for (int k = 0; k < 6; k++)
        s->x[k] += y[k];
    shorten(s->x, 2 * MINIMAL_TAN_HALF_TURN);
    shorten(s->x + 3, MINIMAL_SHIFT_MM);
}

static struct estimate estimate(struct minimal_search *s)
{
    const struct pose pose = pose_at(s, s->x);
    const double area = minimal_places_few(&s->pair, &pose);

    return (struct estimate){minimal_mean(&s->pair.places), area};
}

/* The motion to the least of the estimates.  Returns a disparity (mm) below which a measure there
 * is certainly less than at the alignment, and the area kept; 0: none is. */
static double descend(struct minimal_search *s)
{
    const struct minimal_places *const p = &s->pair.places;
    const struct estimate first = estimate(s);
    struct estimate e = first;
    double y[6], step;

    for (int i = 0; e.gap > MINIMAL_LEVEL_MM; e = estimate(s)) {
        step = minimal_solve(p, e.gap, MINIMAL_FAR_MM, y);
        move(s, y);
        if (++i == MINIMAL_STEPS || step < MINIMAL_SHORT_MM)
            break;
    }
    step = INFINITY;
    for (int i = 0; i < MINIMAL_LOOKS && step > MINIMAL_NEAR_MM; i++) {
        const struct pose pose = pose_at(s, s->x);

        if (!(minimal_places_all(&s->pair, &pose) > 0) ||
            !(minimal_mean(p) > MINIMAL_LEVEL_MM))
            break;
        step = minimal_solve(p, minimal_mean(p), MINIMAL_LAST_MM, y);
        move(s, y);
    }
    e = estimate(s);
    if (s->pair.probe.surface->mesh.nv < MINIMAL_FEW ||
        e.gap >= MINIMAL_SURE_GAP * first.gap || e.area < MINIMAL_SURE_AREA * first.area)
        return 0;
    return MINIMAL_SURE_GAP * first.gap;
}

static enum status minimal_measure(const struct minimal_search *s,
                                   const double transform[16], struct minimal *out)
{
    memcpy(out->transform, transform, sizeof out->transform);
    return measure_at(s->pair.tmpl.surface, s->pair.probe.surface, transform, NULL, s->w,
                      &out->disparity);
}

/* At this share of the motion. */
static enum status measure_along(const struct minimal_search *s, double share,
                                 struct minimal *out)
{
    struct pose pose;
    double x[6], transform[16];

    for (int k = 0; k < 6; k++)
        x[k] = share * s->x[k];
    pose = pose_at(s, x);
    pose_to_matrix(&pose, transform);
    return minimal_measure(s, transform, out);
}

/* Returns true if m may be the result, a being the measure at the alignment. */
static bool allowed(const struct minimal *m, const struct minimal *a)
{
    return m->disparity.plain_mm <= a->disparity.plain_mm &&
           m->disparity.area_mm2 >= MINIMAL_AREA * a->disparity.area_mm2;
}

/* The measure at the motion, or at a shorter one that is allowed. */
static enum status minimal_settle(const struct minimal_search *s, double sure,
                                  struct minimal *out)
{
    static const double still[6] = {0};
    struct minimal aligned = {.transform = {0}};
    enum status st;

    if (memcmp(s->x, still, sizeof still) == 0)
        return minimal_measure(s, s->transform, out);
    st = measure_along(s, 1, out);
    if (st != ST_OK || out->disparity.plain_mm < sure)
        return st;
    st = minimal_measure(s, s->transform, &aligned);
    for (double share = MINIMAL_BACK; st == ST_OK && !allowed(out, &aligned);
         share *= MINIMAL_BACK) {
        if (share < MINIMAL_LEAST_SHARE)
            *out = aligned;
        else
            st = measure_along(s, share, out);
    }
    return st;
}

enum status minimal_find(const struct surface *tmpl, const struct surface *probe,
                         const double transform[16], struct measure_work *w,
                         struct minimal *out)
{
    struct minimal_search s = {
        .pair = {.tmpl = {.surface = tmpl}, .probe = {.surface = probe}},
        .transform = transform,
        .w = w};
    unsigned char *block;

    memset(out, 0, sizeof *out);
    block = scratch_need(&w->scratch, minimal_places_layout(&s.pair, NULL));
    if (block == NULL)
        return ST_ENOMEM;
    (void)minimal_places_layout(&s.pair, block);
    pose_from_matrix(transform, &s.aligned);
    s.pair.centre = pose_apply(&s.aligned, pose_centre(&probe->mesh));
    minimal_places_begin(&s.pair);
    return minimal_settle(&s, descend(&s), out);
}
