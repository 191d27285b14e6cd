#include "find_search.h"

#include <math.h>
#include <string.h>

#include "find_grid.h"
#include "find_nose.h"

/* ---- limits */

bool find_search_stopped(const struct find_search *s)
{
    return s->stop != NULL && atomic_load_explicit(s->stop, memory_order_relaxed);
}

bool find_search_spend(struct find_search *s, int64_t work)
{
    s->left = find_search_stopped(s) ? 0 : s->left - work;
    return s->left > 0;
}

/* ---- starting poses */

/* Keep the best starts, by rising cost. */
static void keep(struct find_search *s, uint32_t nose, const struct find_place *p)
{
    uint32_t i;

    if (s->starts == FIND_STARTS && !(p->cost < s->start[FIND_STARTS - 1].place.cost))
        return;
    i = s->starts < FIND_STARTS ? s->starts++ : FIND_STARTS - 1;
    for (; i > 0 && p->cost < s->start[i - 1].place.cost; i--)
        s->start[i] = s->start[i - 1];
    s->start[i] = (struct find_start){nose, *p};
}

/* The rolls about an axis that are better than their neighbours. */
static void roll(struct find_search *s, uint32_t nose, const float axis[3])
{
    struct find_place p[FIND_ROLLS];

    find_place_turn(&s->samples, &s->near, axis, p);
    for (int r = 0; r < FIND_ROLLS; r++)
        if (p[r].cost <= p[(r + 1) % FIND_ROLLS].cost &&
            p[r].cost < p[(r + FIND_ROLLS - 1) % FIND_ROLLS].cost)
            keep(s, nose, &p[r]);
}

static void collect(const struct find_grid *g, const struct find_nose *nose, uint32_t n,
                    bool tilted, struct find_search *s)
{
    s->starts = 0;
    for (uint32_t k = 0; k < n && s->left > 0; k++) {
        find_near_get(g, nose[k].at, &s->near);
        (void)find_search_spend(s, FIND_ROLLS * FIND_SAMPLES +
                                       s->near.n * (tilted ? 1 + FIND_TILTS : 1));
        roll(s, k, nose[k].axis);
        for (int i = 0; tilted && i < FIND_TILTS; i++) {
            float axis[3];

            find_place_tilt(nose[k].axis, i, axis);
            roll(s, k, axis);
        }
    }
}

/* ---- poses */

/* Less than FIND_SAME_MM and FIND_SAME_TRACE apart? */
static bool same(const struct find_found *a, const struct find_found *b)
{
    const struct align_pose d = align_pose_after(&a->pose, &b->pose);
    const struct dvec3 way = vec_sub(a->nose, b->nose);

    return a->unit_mm == b->unit_mm && vec_dot(way, way) < FIND_SAME_MM * FIND_SAME_MM &&
           d.r[0] + d.r[4] + d.r[8] > FIND_SAME_TRACE;
}

static void take(struct find_list *l, const struct find_found *f)
{
    uint32_t i = 0;

    while (i < l->n && !same(&l->found[i], f))
        i++;
    if (i < l->n ? f->key <= l->found[i].key
                 : l->n == FIND_FOUND && f->key <= l->found[FIND_FOUND - 1].key)
        return;
    if (i == l->n)
        i = l->n < FIND_FOUND ? l->n++ : FIND_FOUND - 1;
    for (; i > 0 && f->key > l->found[i - 1].key; i--)
        l->found[i] = l->found[i - 1];
    l->found[i] = *f;
}

bool find_search_plain(const struct find_search *s)
{
    return s->best.n > 0 && s->best.found[0].key >= FIND_PLAIN;
}

bool find_search_likely(const struct find_search *s)
{
    return s->best.n > 0 && s->best.found[0].key >= FIND_LIKELY;
}

/* Is a plain pose's face at a place already? */
static bool taken(const struct find_search *s, double unit_mm, struct dvec3 at)
{
    for (uint32_t i = 0; i < s->best.n && s->best.found[i].key >= FIND_PLAIN; i++) {
        const struct dvec3 way = vec_sub(at, s->best.found[i].nose);

        if (s->best.found[i].unit_mm != unit_mm ||
            vec_dot(way, way) < FIND_OTHER_MM * FIND_OTHER_MM)
            return true;
    }
    return false;
}

/* The pose that a start stands for. */
static struct find_found found_at(const struct find_grid *g, const struct find_nose *nose,
                                  const struct find_place *start, const double tip[3])
{
    struct find_found f = {.unit_mm = g->unit_mm};
    double *r = f.pose.r;
    double p[3] = {g->corner.x + (double)nose->at[0], g->corner.y + (double)nose->at[1],
                   g->corner.z + (double)nose->at[2]};

    for (int i = 0; i < 9; i++)
        r[i] = (double)start->r[i];
    for (int i = 0; i < 3; i++)
        p[i] -= r[i] * tip[0] + r[3 + i] * tip[1] + r[6 + i] * tip[2];
    f.nose = (struct dvec3){p[0], p[1], p[2]};
    return f;
}

/* Refine f from its rotation and nose; the rest of it is filled. */
static void settle(const struct find_grid *g, struct find_search *s, bool fine,
                   struct find_found *f)
{
    const struct dvec3 at = vec_sub(f->nose, g->corner);
    struct find_fit fit = {.pose = f->pose};
    struct align_pose *p = &f->pose;
    const struct dvec3 from = f->nose;

    memset(fit.pose.t, 0, sizeof fit.pose.t);
    find_near_get(g, (const float[3]){(float)at.x, (float)at.y, (float)at.z}, &s->near);
    find_refine(s->mean, &s->near, fine, &s->front, &fit);
    (void)find_search_spend(s, GRID_N + s->front.n * 8);
    *p = fit.pose;
    for (int i = 0; i < 3; i++)
        p->t[i] -=
            p->r[3 * i] * from.x + p->r[3 * i + 1] * from.y + p->r[3 * i + 2] * from.z;
    f->nose = align_pose_origin(p);
    f->points = fit.points;
    f->key = fit.key;
    f->likeness = fit.likeness;
    f->covered = fit.covered;
}

/* The best starts, until a face is plain; then those elsewhere that may well be another. */
static double refine(const struct find_grid *g, const struct find_nose *nose,
                     uint32_t most, struct find_search *s)
{
    struct find_list coarse = {.n = 0};
    double best = -1;

    for (uint32_t k = 0; k < s->starts && most > 0 && s->left > 0; k++) {
        const struct find_start *start = &s->start[k];
        struct find_found f =
            found_at(g, &nose[start->nose], &start->place, s->samples.tip);

        if (taken(s, g->unit_mm, f.nose) ||
            (find_search_plain(s) && start->place.cost > FIND_OTHER_COST_MM))
            continue;
        settle(g, s, false, &f);
        most--;
        if (f.key >= FIND_HOPEFUL) {
            settle(g, s, true, &f);
            best = fmax(best, f.key);
            take(&s->best, &f);
        } else
            take(&coarse, &f);
    }
    for (uint32_t k = 0; k < coarse.n && k < FIND_FINE && !find_search_plain(s); k++) {
        settle(g, s, true, &coarse.found[k]);
        best = fmax(best, coarse.found[k].key);
        take(&s->best, &coarse.found[k]);
    }
    return best;
}

void find_search_begin(const struct frame_mean *mean, const atomic_bool *stop,
                       struct find_search *s)
{
    s->mean = mean;
    s->stop = stop;
    s->best.n = 0;
    s->left = FIND_WORK;
    find_place_samples(mean, &s->samples);
}

double find_search_grid(struct find_search *s, const struct find_grid *g,
                        const struct find_nose *nose, uint32_t n,
                        const struct find_effort *e)
{
    collect(g, nose, n < e->noses ? n : e->noses, e->tilted, s);
    return refine(g, nose, e->places, s);
}
