#include "train.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calibrate.h"
#include "cells.h"
#include "corpus.h"
#include "errinfo.h"
#include "face.h"
#include "fit.h"
#include "learn.h"
#include "mem.h"
#include "pool.h"
#include "score.h"
#include "train_mean.h"
#include "train_motion.h"
#include "train_set.h"
#include "train_shape.h"
#include "tuning.h"

/* What each brings: docs/accuracy.md, "The method, part by part".  Smooth modes of 30 mm
 * accept 2 to 3 % fewer unseen expressions. */
#define CHANGE_MODES 24
#define SMOOTH_MODES 40
#define SMOOTH_MM    20.0
#define SMOOTH_SHARE 0.5
#define CAP_MM       1.0

#define IMPOSTORS 12   /* non-mated pairs of each probe: TRAIN_MIN_PROBES */
#define JUDGED    4000 /* non-mated pairs in the figures, or all: enough for FMR 0.1 % */

struct pair {
    uint32_t template, probe; /* of corpus.scan */
    bool genuine;
    bool judged;          /* counts in the figures before and after */
    size_t place;         /* in the order of halves */
    double transform[16]; /* that was found, */
    double overlap;       /* with this share of the template; 0: apart */
};

/* A model learned from some of the pairs. */
struct learner {
    struct model *m;
    struct fit_basis change; /* m's, prepared */
    unsigned half;           /* of the subjects; BOTH */
    float *rest;             /* [n][GRID_N] what its change leaves, of its own pairs */
    const uint8_t *genuine;  /* [n] */
    size_t n;
};

#define BOTH 2

struct train {
    const struct train_set *set;
    const struct model *base;
    struct model *m;         /* that is learned */
    struct fit_basis change; /* its, prepared, once it is known */
    unsigned threads;
    void (*say)(void *arg, const char *line);
    void *arg;
    struct pair *pair;
    size_t n, ngenuine; /* genuine ones first */
    float *gap;         /* [n][GRID_N] learn_sample() at the pose found */
    double *mm;         /* [n] score by a model; INFINITY: inconclusive */

    struct learner by[3];              /* both halves, and for cross-validation each */
    float *rest_all, *rest_halves;     /* [n][GRID_N]; by place of by[1] and by[2] */
    uint8_t *genuine, *genuine_halves; /* [n] */
};

__attribute__((format(printf, 2, 3))) static void tell(const struct train *t,
                                                       const char *format, ...)
{
    char line[200];
    va_list args;

    if (t->say == NULL)
        return;
    va_start(args, format);
    (void)vsnprintf(line, sizeof line, format, args);
    va_end(args);
    t->say(t->arg, line);
}

/* ---- pairs, on all cores: each item writes its own place, so the order does not matter */

static const struct face *face_at(const struct train *t, uint32_t scan)
{
    return &t->set->face[scan];
}

/* The pose that face_compare() finds, and the gap there. */
static enum status gap_found(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    struct train *t = arg;
    struct pair *p = &t->pair[i];
    struct face_result r;
    struct cells cells;
    enum status st =
        face_compare(face_at(t, p->template), face_at(t, p->probe), 0, NULL, w, &r);

    if (st == ST_OK)
        st = face_gap(face_at(t, p->template), face_at(t, p->probe), r.align.transform, w,
                      &cells);
    if (st != ST_OK)
        return errinfo_set(e, st, "aligning the pairs: %s", status_message(st));
    memcpy(p->transform, r.align.transform, sizeof p->transform);
    p->overlap = r.align.stop == ALIGN_APART ? 0 : r.overlap;
    learn_sample(&cells, t->gap + i * GRID_N);
    return ST_OK;
}

/* The score by the base model. */
static enum status judge_before(void *arg, size_t i, struct face_work *w,
                                struct errinfo *e)
{
    struct train *t = arg;
    const struct pair *p = &t->pair[i];
    struct face_result r;
    enum status st;

    if (!p->judged)
        return ST_OK;
    st = face_compare(face_at(t, p->template), face_at(t, p->probe), 0, NULL, w, &r);
    if (st != ST_OK)
        return errinfo_set(e, st, "judging by the base model: %s", status_message(st));
    t->mm[i] = r.decision == FACE_INCONCLUSIVE ? (double)INFINITY : r.score_mm;
    return ST_OK;
}

static double decided_mm(const struct score *s, double overlap)
{
    return s->weight < DECISION_MIN_WEIGHT || overlap < DECISION_MIN_OVERLAP
               ? (double)INFINITY
               : s->mm;
}

/* The score by the new model, at the pose found before: alignment does not depend on change
 * and weight. */
static enum status judge_after(void *arg, size_t i, struct face_work *w,
                               struct errinfo *e)
{
    struct train *t = arg;
    const struct pair *p = &t->pair[t->ngenuine + i];
    struct scratch s = {0};
    struct cells cells;
    struct score score;
    struct fit fit;
    enum status st =
        face_gap(face_at(t, p->template), face_at(t, p->probe), p->transform, w, &cells);

    if (st == ST_OK)
        st = score_of(t->m, &t->change, &cells, &s, &fit, &score);
    scratch_free(&s);
    if (st != ST_OK)
        return errinfo_set(e, st, "calibrating: %s", status_message(st));
    t->mm[t->ngenuine + i] = decided_mm(&score, p->overlap);
    return ST_OK;
}

static bool there(const struct train *t, uint32_t scan)
{
    return face_at(t, scan)->surface.mesh.nv > 0;
}

/* Every probe with its own template; how many subjects have one. */
static uint32_t plan_genuine(struct train *t)
{
    const struct corpus *c = t->set->corpus;
    uint32_t subjects = 0;

    for (uint32_t i = 0; i < c->nscan; i++) {
        const uint32_t own = c->subject[c->scan[i].subject].enrolled;

        if (!c->scan[i].enrolled && there(t, i) && there(t, own))
            t->pair[t->n++] = (struct pair){
                .template = own, .probe = i, .genuine = true, .judged = true};
    }
    t->ngenuine = t->n;
    for (uint32_t s = 0; s < c->nsubject; s++)
        subjects += there(t, c->subject[s].enrolled);
    return subjects;
}

/* Every probe with IMPOSTORS other templates, spread over the others. */
static void plan_impostors(struct train *t)
{
    const struct corpus *c = t->set->corpus;
    const size_t judged = (JUDGED + t->ngenuine - 1) / t->ngenuine;

    for (size_t g = 0; g < t->ngenuine; g++) {
        const uint32_t probe = t->pair[g].probe, subject = c->scan[probe].subject;
        uint64_t seed = probe;
        uint32_t found = 0;

        for (int tries = 0; tries < 50 * IMPOSTORS && found < IMPOSTORS; tries++) {
            const uint32_t s = rates_below(&seed, c->nsubject);
            const uint32_t other = c->subject[s].enrolled;
            bool again =
                corpus_pair(c, s, subject) != CORPUS_IMPOSTOR || !there(t, other);

            for (uint32_t i = 0; i < found && !again; i++)
                again = t->pair[t->n - 1 - i].template == other;
            if (!again)
                t->pair[t->n++] = (struct pair){
                    .template = other, .probe = probe, .judged = found++ < judged};
        }
    }
}

/* Which half of the subjects a pair's probe belongs to. */
static unsigned half_of(const struct train *t, size_t i)
{
    return t->set->corpus->scan[t->pair[i].probe].subject & 1;
}

/* Allocate what is learned, and divide the pairs among the learners. */
static enum status make_room(struct train *t)
{
    size_t n = 0;

    t->gap = calloc(t->n, GRID_N * sizeof *t->gap);
    t->rest_all = calloc(t->n, GRID_N * sizeof *t->rest_all);
    t->rest_halves = calloc(t->n, GRID_N * sizeof *t->rest_halves);
    t->mm = calloc(t->n, sizeof *t->mm);
    t->genuine = calloc(t->n, 1);
    t->genuine_halves = calloc(t->n, 1);
    for (int i = 0; i < 3; i++)
        t->by[i].m = calloc(1, sizeof *t->by[i].m);
    if (t->gap == NULL || t->rest_all == NULL || t->rest_halves == NULL ||
        t->mm == NULL || t->genuine == NULL || t->genuine_halves == NULL ||
        t->by[0].m == NULL || t->by[1].m == NULL || t->by[2].m == NULL)
        return ST_ENOMEM;
    t->by[0].half = BOTH;
    t->by[0].rest = t->rest_all;
    t->by[0].genuine = t->genuine;
    t->by[0].n = t->n;
    for (unsigned h = 0; h < 2; h++) {
        struct learner *const l = &t->by[1 + h];

        l->half = h;
        l->rest = t->rest_halves + n * GRID_N;
        l->genuine = t->genuine_halves + n;
        for (size_t i = 0; i < t->n; i++)
            if (half_of(t, i) == h) {
                t->genuine[i] = t->genuine_halves[n] = t->pair[i].genuine;
                t->pair[i].place = n++;
                l->n++;
            }
    }
    return ST_OK;
}

static enum status plan(struct train *t, struct errinfo *e)
{
    uint32_t subjects;

    t->pair = calloc((size_t)t->set->corpus->nscan * (IMPOSTORS + 1), sizeof *t->pair);
    if (t->pair == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    subjects = plan_genuine(t);
    if (subjects < TRAIN_MIN_SUBJECTS || t->ngenuine < TRAIN_MIN_PROBES)
        return errinfo_set(
            e, ST_EINVAL,
            "%u subjects and %zu further scans of them are too few to learn "
            "from: %d and %d are needed",
            subjects, t->ngenuine, TRAIN_MIN_SUBJECTS, TRAIN_MIN_PROBES);
    plan_impostors(t);
    if (!rates_supported(TRAIN_FMR, t->n - t->ngenuine))
        return errinfo_set(
            e, ST_EINVAL,
            "%zu pairs of different people are too few to calibrate with: %zu "
            "are needed",
            t->n - t->ngenuine, rates_needed(TRAIN_FMR));
    return make_room(t) == ST_OK ? ST_OK : errinfo_set(e, ST_ENOMEM, "out of memory");
}

/* ---- learning: each step for all three learners at once */

/* A learner's change, from the genuine gaps of its half. */
static enum status learn_change(void *arg, size_t i, struct face_work *w,
                                struct errinfo *e)
{
    struct train *t = arg;
    struct learner *l = &t->by[i];
    float *samples = malloc(t->ngenuine * GRID_N * sizeof *samples);
    enum status st = ST_ENOMEM;
    size_t n = 0;

    (void)w;
    if (samples != NULL) {
        for (size_t g = 0; g < t->ngenuine; g++)
            if (l->half == BOTH || half_of(t, g) == l->half)
                memcpy(samples + GRID_N * n++, t->gap + g * GRID_N,
                       GRID_N * sizeof *samples);
        *l->m = *t->m;
        st = learn_modes(samples, n, CHANGE_MODES, LEARN_MAX_GAP, &l->m->change);
    }
    if (st == ST_OK)
        st = learn_smooth(&l->m->change, SMOOTH_MM, SMOOTH_SHARE, SMOOTH_MODES);
    if (st == ST_OK)
        fit_prepare(&l->m->change, &l->change);
    free(samples);
    return st == ST_OK
               ? ST_OK
               : errinfo_set(e, st, "learning what changes: %s", status_message(st));
}

static enum status fit_pair(const struct train *t, size_t i, const struct learner *l,
                            struct score *score, struct fit *fit)
{
    struct scratch s = {0};
    struct cells cells;
    enum status st;

    learn_cells(t->gap + i * GRID_N, l->m, &cells);
    st = score_of(l->m, &l->change, &cells, &s, fit, score);
    scratch_free(&s);
    return st;
}

/* The rest of a pair by a learner that learned from it: every pair twice, by the learner of
 * both halves and by that of its own half. */
static enum status fit_own(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    struct train *t = arg;
    const size_t p = i % t->n;
    const struct learner *l = &t->by[i < t->n ? 0 : 1 + half_of(t, p)];
    const float *gap = t->gap + p * GRID_N;
    float *rest =
        i < t->n ? t->rest_all + p * GRID_N : t->rest_halves + t->pair[p].place * GRID_N;
    struct score score;
    struct fit fit;
    const enum status st = fit_pair(t, p, l, &score, &fit);

    (void)w;
    if (st != ST_OK)
        return errinfo_set(e, st, "taking change out: %s", status_message(st));
    for (uint32_t c = 0; c < GRID_N; c++)
        rest[c] = isnan(gap[c]) ? (float)NAN : fit.rest[c];
    return ST_OK;
}

static enum status learn_where(void *arg, size_t i, struct face_work *w,
                               struct errinfo *e)
{
    const struct train *t = arg;
    const struct learner *l = &t->by[i];
    const enum status st = learn_weight(l->rest, l->genuine, l->n, l->m, l->m->weight);

    (void)w;
    return st == ST_OK
               ? ST_OK
               : errinfo_set(e, st, "learning the weight: %s", status_message(st));
}

/* A pair's score by the learner of the other half of the subjects. */
static enum status judge_other(void *arg, size_t i, struct face_work *w,
                               struct errinfo *e)
{
    struct train *t = arg;
    struct score score;
    struct fit fit;
    enum status st;

    (void)w;
    if (!t->pair[i].judged)
        return ST_OK;
    st = fit_pair(t, i, &t->by[2 - half_of(t, i)], &score, &fit);
    if (st != ST_OK)
        return errinfo_set(e, st, "judging the other half: %s", status_message(st));
    t->mm[i] = decided_mm(&score, t->pair[i].overlap);
    return ST_OK;
}

/* The rates of the judged pairs, or of all non-mated pairs. */
static enum status rates(const struct train *t, bool impostors, struct rates **out,
                         struct errinfo *e)
{
    const struct corpus *c = t->set->corpus;
    struct rates_score *s = calloc(t->n, sizeof *s);
    enum status st = ST_ENOMEM;
    size_t n = 0;

    *out = NULL;
    if (s != NULL) {
        for (size_t i = 0; i < t->n; i++)
            if (impostors ? !t->pair[i].genuine : t->pair[i].judged)
                s[n++] =
                    (struct rates_score){t->mm[i], c->scan[t->pair[i].template].subject,
                                         c->scan[t->pair[i].probe].subject};
        st = rates_new(s, n, c->nsubject, out);
    }
    free(s);
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "the rates: %s", status_message(st));
}

static enum status figures(const struct train *t, struct rates_figures *out,
                           struct errinfo *e)
{
    struct rates *r;
    const enum status st = rates(t, false, &r, e);

    if (st == ST_OK)
        rates_figures(r, t->base->decision.threshold_mm, out);
    rates_free(r);
    return st;
}

/* Round m as its text form does: the rounded model is the one that is used. */
static enum status as_text(struct model *m)
{
    const size_t len = model_write(m, NULL, 0);
    char *text = malloc(len + 1);
    enum status st = ST_ENOMEM;

    if (text != NULL) {
        (void)model_write(m, text, len + 1);
        st = model_parse(text, len, m, NULL);
    }
    free(text);
    return st;
}

/* item(0..n-1) on all cores. */
static enum status each(struct train *t, const char *what, const struct model *m,
                        size_t n, pool_item *item, struct errinfo *e)
{
    return pool_run(what, t->threads, m, n, item, t, e);
}

static enum status calibrate(struct train *t, struct errinfo *e)
{
    struct rates *r = NULL;
    enum status st;

    fit_prepare(&t->m->change, &t->change);
    st = each(t, "calibrating", t->m, t->n - t->ngenuine, judge_after, e);

    if (st == ST_OK)
        st = rates(t, true, &r, e);
    if (st == ST_OK && calibrate_learn(r, TRAIN_FMR, &t->m->decision) != ST_OK)
        st = errinfo_set(e, ST_EINVAL,
                         "calibrating: too few of %zu pairs of different people could be "
                         "compared",
                         rates_nimpostor(r));
    rates_free(r);
    return st;
}

static enum status rounded(struct train *t, struct errinfo *e)
{
    const enum status st = as_text(t->m);

    return st == ST_OK ? ST_OK
                       : errinfo_set(e, st,
                                     "what was learned is no model: %s; are these "
                                     "scans of faces?",
                                     status_message(st));
}

static enum status place(struct train *t, struct errinfo *e)
{
    enum status st = train_mean(t->set, t->threads, t->m, e);

    if (st != ST_OK)
        return st;
    tell(t, "mean face and frames found");
    t->m->motion = t->base->motion;
    t->m->cap_mm = (float)CAP_MM;
    if (t->set->corpus->posed) {
        if ((st = train_motion(t->set, t->threads, t->m, e)) != ST_OK)
            return st;
        tell(t, "motion learned from the poses that are known");
    }
    if ((st = train_shape(t->set, t->m, e)) != ST_OK)
        return st;
    tell(t, "shape learned");
    if ((st = rounded(t, e)) == ST_OK &&
        (st = each(t, "aligning", t->m, t->n, gap_found, e)) == ST_OK)
        tell(t, "all pairs aligned");
    return st;
}

static enum status steps(struct train *t, struct train_report *report, struct errinfo *e)
{
    enum status st;

    tell(t, "%zu pairs of one subject, %zu of different ones", t->ngenuine,
         t->n - t->ngenuine);
    if ((st = each(t, "before", t->base, t->n, judge_before, e)) != ST_OK ||
        (st = figures(t, &report->before, e)) != ST_OK)
        return st;
    tell(t, "before: EER %.2f %%, accepted at FMR 0.1 %%: %.1f %%",
         100 * report->before.eer, 100 * report->before.tar[1]);
    if ((st = place(t, e)) != ST_OK ||
        (st = each(t, "change", t->m, 3, learn_change, e)) != ST_OK ||
        (st = each(t, "fitting", t->m, 2 * t->n, fit_own, e)) != ST_OK ||
        (st = each(t, "weight", t->m, 3, learn_where, e)) != ST_OK ||
        (st = each(t, "judging", t->m, t->n, judge_other, e)) != ST_OK ||
        (st = figures(t, &report->after, e)) != ST_OK)
        return st;
    tell(
        t,
        "after, on subjects not learned from: EER %.2f %%, accepted at FMR 0.1 %%: %.1f %%",
        100 * report->after.eer, 100 * report->after.tar[1]);
    *t->m = *t->by[0].m;
    if ((st = rounded(t, e)) != ST_OK || (st = calibrate(t, e)) != ST_OK ||
        (st = rounded(t, e)) != ST_OK)
        return st;
    report->threshold_mm = t->m->decision.threshold_mm;
    return ST_OK;
}

enum status train_model(const struct train_set *set, const struct model *base,
                        const char *name, unsigned threads,
                        void (*say)(void *arg, const char *line), void *arg,
                        struct model *out, struct train_report *report, struct errinfo *e)
{
    struct train t = {
        .set = set, .base = base, .m = out, .threads = threads, .say = say, .arg = arg};
    enum status st;

    memset(out, 0, sizeof *out);
    memset(report, 0, sizeof *report);
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    if ((st = plan(&t, e)) == ST_OK)
        st = steps(&t, report, e);
    report->genuine = t.ngenuine;
    report->impostor = t.n - t.ngenuine;
    free(t.pair);
    free(t.gap);
    free(t.rest_all);
    free(t.rest_halves);
    free(t.mm);
    free(t.genuine);
    free(t.genuine_halves);
    for (int i = 0; i < 3; i++)
        free(t.by[i].m);
    return st;
}
