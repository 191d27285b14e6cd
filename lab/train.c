#include "train.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "place.h"
#include "pose.h"
#include "command.h"
#include "corpus.h"
#include "csv.h"
#include "errinfo.h"
#include "face.h"
#include "heights.h"
#include "pool.h"
#include "population_scans.h"

#define CALIBRATED_FMR 0.001
#define STRANGERS      20 /* that each scan is compared with, at most */

/* A scan that is used. */
struct sample {
    uint32_t scan;    /* of the corpus */
    uint32_t subject; /* numbered anew: of those used */
    struct surface_face
        placed; /* the scan's face as the model in use sees it; its points borrowed */
};

struct train_pair {
    uint32_t template, probe; /* of the samples */
    double base, own;         /* scores */
};

struct train_work {
    const struct train *t;
    const struct population *p;  /* that gaps are from */
    struct sample *sample;       /* [n] by subjects */
    struct population_scan *gap; /* [n] */
    uint32_t *first;             /* [nsubject + 1] of each subject's samples */
    uint32_t n, nsubject;
    struct train_pair *pair; /* [npair] by probes */
    size_t npair;
    unsigned half; /* of the subjects that is compared; BOTH */
};

#define BOTH 2

/* ---- which scans, which comparisons */

/* The scans that have faces, by subjects; every subject with two or more. */
static enum status train_choose(struct train_work *w, struct errinfo *e)
{
    const struct corpus *c = w->t->corpus;
    uint32_t *count = calloc(c->nsubject + (size_t)1, sizeof *count);
    uint32_t *at = calloc(c->nsubject + (size_t)1, sizeof *at), several = 0;

    w->sample = calloc(c->nscan, sizeof *w->sample);
    w->gap = calloc(c->nscan, sizeof *w->gap);
    w->first = calloc(c->nsubject + (size_t)1, sizeof *w->first);
    if (count == NULL || at == NULL || w->sample == NULL || w->gap == NULL ||
        w->first == NULL) {
        free(count);
        free(at);
        return errinfo_memory(e);
    }
    for (uint32_t i = 0; i < c->nscan; i++)
        count[c->scan[i].subject] += w->t->face[i].surface.mesh.nv > 0;
    for (uint32_t s = 0; s < c->nsubject; s++)
        if (count[s] > 0) {
            several += count[s] > 1;
            at[s] = w->nsubject;
            w->first[w->nsubject + 1] = w->first[w->nsubject] + count[s];
            w->nsubject++;
        }
    memset(count, 0, c->nsubject * sizeof *count);
    for (uint32_t i = 0; i < c->nscan; i++) {
        const uint32_t s = c->scan[i].subject;

        if (w->t->face[i].surface.mesh.nv > 0) {
            w->sample[w->first[at[s]] + count[s]++] =
                (struct sample){.scan = i, .subject = at[s]};
            w->n++;
        }
    }
    free(count);
    free(at);
    return several >= TRAIN_MIN_SUBJECTS
               ? ST_OK
               : errinfo_set(e, ST_ETOOFEW,
                             "%u subjects with two scans or more are too few to learn "
                             "from: %d are needed",
                             several, TRAIN_MIN_SUBJECTS);
}

static unsigned half_of(const struct train_work *w, uint32_t sample)
{
    return w->sample[sample].subject & 1;
}

/* The subject of the corpus that a subject in use is. */
static uint32_t person(const struct train_work *w, uint32_t subject)
{
    return w->t->corpus->scan[w->sample[w->first[subject]].scan].subject;
}

/* Each scan with its subject's first one, and with the first ones of others of the same half. */
static enum status plan(struct train_work *w, struct errinfo *e)
{
    w->pair = calloc((size_t)w->n * (STRANGERS + 1), sizeof *w->pair);
    if (w->pair == NULL)
        return errinfo_memory(e);
    for (uint32_t i = 0; i < w->n; i++) {
        const uint32_t own = w->sample[i].subject;
        uint32_t found = 0;

        if (i != w->first[own])
            w->pair[w->npair++] =
                (struct train_pair){.template = w->first[own], .probe = i};
        for (uint32_t k = 1; k < w->nsubject && found < STRANGERS; k++) {
            const uint32_t s = (own + k) % w->nsubject;

            if ((s & 1) != (own & 1) || corpus_pair(w->t->corpus, person(w, own),
                                                    person(w, s)) != CORPUS_IMPOSTOR)
                continue;
            w->pair[w->npair++] =
                (struct train_pair){.template = w->first[s], .probe = i};
            found++;
        }
    }
    return ST_OK;
}

/* ---- faces by a model, on all cores: each item writes its own place */

/* The scan's frame and encoding by the work's model; and its gaps. */
static enum status train_place(void *arg, size_t i, struct surface_work *work,
                               struct errinfo *e)
{
    struct train_work *w = arg;
    struct sample *s = &w->sample[i];
    struct scratch room = {0};
    float z[GRID_N];
    enum status st;

    if (w->half != BOTH && half_of(w, (uint32_t)i) != w->half)
        return ST_OK;
    s->placed = w->t->face[s->scan];
    st = place_find(&s->placed, work);
    if (st == ST_OK && w->p != NULL) {
        st = heights_of(&s->placed.surface, &s->placed.frame.pose, &room, z);
        w->gap[i].subject = s->subject;
        if (st == ST_OK)
            (void)population_scans_gap(w->p, z, w->gap[i].gap);
    }
    scratch_free(&room);
    return st == ST_OK ? ST_OK
                       : errinfo_set(e, st, "placing the faces: %s", status_message(st));
}

static enum status train_compare(const struct surface_face *tmpl,
                                 const struct surface_face *probe,
                                 struct surface_work *work, double *score,
                                 struct errinfo *e)
{
    struct surface_comparison r;
    const enum status st = status_from(surface_compare(work, tmpl, probe, &r));

    if (st != ST_OK)
        return errinfo_set(e, st, "comparing: %s", status_message(st));
    *score = r.score;
    return ST_OK;
}

static enum status compare_base(void *arg, size_t i, struct surface_work *work,
                                struct errinfo *e)
{
    struct train_work *w = arg;
    struct train_pair *p = &w->pair[i];

    return train_compare(&w->t->face[w->sample[p->template].scan],
                         &w->t->face[w->sample[p->probe].scan], work, &p->base, e);
}

static enum status compare_own(void *arg, size_t i, struct surface_work *work,
                               struct errinfo *e)
{
    struct train_work *w = arg;
    struct train_pair *p = &w->pair[i];

    if (half_of(w, p->probe) != w->half)
        return ST_OK;
    return train_compare(&w->sample[p->template].placed, &w->sample[p->probe].placed,
                         work, &p->own, e);
}

/* ---- learning */

/* Round m as its text form does: the rounded model is the one that is used. */
static enum status round_model(struct surface_model *m, struct errinfo *e)
{
    const size_t len = surface_model_write(m, NULL, 0);
    char *text = malloc(len + 1);
    enum status st;

    if (text == NULL)
        return errinfo_memory(e);
    (void)surface_model_write(m, text, len + 1);
    st = model_parse(text, len, m, NULL);
    free(text);
    return st == ST_OK ? ST_OK
                       : errinfo_set(e, ST_ECORRUPT, "the learned model is not valid");
}

static enum status to_model(const struct population *p, struct surface_model *m,
                            struct errinfo *e)
{
    const enum status st = population_model(p, m);

    return st == ST_OK ? round_model(m, e)
                       : errinfo_set(e, st, "the prior of faces is not a valid model: %s",
                                     status_message(st));
}

static enum status train_begin(const struct train *t, struct population *p,
                               struct errinfo *e)
{
    const enum status st = population_read(t->base, p);

    return st == ST_OK ? ST_OK
                       : errinfo_set(e, st == ST_EINVAL ? ST_ECORRUPT : st,
                                     "the model to begin with: %s",
                                     st == ST_EINVAL ? "too few cells are symmetric"
                                                     : status_message(st));
}

/* The gaps of a half of the subjects, or of all, blended into p. */
static enum status blend(const struct train_work *w, unsigned half, double weight,
                         struct population *p, struct errinfo *e)
{
    struct population_scan *own = calloc(w->n, sizeof *own);
    enum status st = ST_ENOMEM;
    size_t n = 0;

    for (uint32_t i = 0; own != NULL && i < w->n; i++)
        if (half == BOTH || half_of(w, i) == half)
            own[n++] = w->gap[i];
    if (own != NULL)
        st = population_scans_blend(p, own, n, weight);
    free(own);
    return st == ST_OK ? ST_OK : errinfo_memory(e);
}

/* What a model says that has learned from the other half of the subjects. */
static enum status judge_half(struct train_work *w, unsigned half, double weight,
                              const struct surface_model *before, struct errinfo *e)
{
    struct population p;
    struct surface_model *m = malloc(sizeof *m);
    struct train_work judge = *w;
    enum status st = m != NULL ? population_copy(w->p, &p) : ST_ENOMEM;

    if (st != ST_OK) {
        free(m);
        return errinfo_memory(e);
    }
    *m = *before;
    judge.p = NULL;
    judge.half = half;
    st = blend(w, 1 - half, weight, &p, e);
    if (st == ST_OK)
        st = to_model(&p, m, e);
    if (st == ST_OK)
        st = pool_run("placing", w->t->threads, m, w->n, train_place, &judge, e);
    if (st == ST_OK)
        st = pool_run("comparing", w->t->threads, m, w->npair, compare_own, &judge, e);
    population_free(&p);
    free(m);
    return st;
}

/* ---- the report */

static enum status train_figures(const struct train_work *w, bool own,
                                 struct rates_figures *out, struct errinfo *e)
{
    struct rates_score *s = calloc(w->npair + 1, sizeof *s);
    struct rates *r = NULL;
    enum status st = s != NULL ? ST_OK : ST_ENOMEM;

    for (size_t i = 0; st == ST_OK && i < w->npair; i++)
        s[i] = (struct rates_score){own ? w->pair[i].own : w->pair[i].base,
                                    w->sample[w->pair[i].template].subject,
                                    w->sample[w->pair[i].probe].subject};
    if (st == ST_OK && (st = rates_new(s, w->npair, w->nsubject, &r)) == ST_OK)
        rates_figures(r, w->t->base->calibration.threshold, out);
    rates_free(r);
    free(s);
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "the rates: %s", status_message(st));
}

static enum status train_report_on(const struct train_work *w, struct train_report *r,
                                   struct errinfo *e)
{
    enum status st = train_figures(w, false, &r->base, e);

    if (st == ST_OK)
        st = train_figures(w, true, &r->own, e);
    if (st != ST_OK)
        return st;
    for (size_t i = 0; i < w->npair; i++)
        if (w->sample[w->pair[i].template].subject == w->sample[w->pair[i].probe].subject)
            r->mated++;
        else
            r->non_mated++;
    r->nsubject = w->nsubject;
    r->nscan = w->n;
    r->worse = (r->own.eer > r->base.eer && r->own.tar[0] <= r->base.tar[0]) ||
               (r->own.eer >= r->base.eer && r->own.tar[0] < r->base.tar[0]);
    return ST_OK;
}

/* p adapted to the scans, and how well that serves people that were not learned from. */
static enum status learn_scans(struct train_work *w, struct population *p,
                               struct surface_model *m, struct train_report *r,
                               struct errinfo *e)
{
    const struct train *t = w->t;
    enum status st = train_choose(w, e);

    if (st == ST_OK)
        st = plan(w, e);
    if (st == ST_OK)
        st = to_model(p, m, e);
    if (st != ST_OK)
        return st;
    r->weight = t->weight >= 0 ? t->weight : population_scans_share(w->nsubject);
    w->p = p;
    w->half = BOTH;
    st = pool_run("placing", t->threads, m, w->n, train_place, w, e);
    if (st == ST_OK)
        st = pool_run("comparing", t->threads, t->base, w->npair, compare_base, w, e);
    for (unsigned half = 0; st == ST_OK && half < 2; half++)
        st = judge_half(w, half, r->weight, m, e);
    if (st == ST_OK)
        st = train_report_on(w, r, e);
    return st == ST_OK ? blend(w, BOTH, r->weight, p, e) : st;
}

static enum status learn(const struct train *t, struct surface_model *out,
                         struct train_report *r, struct errinfo *e)
{
    struct train_work w = {.t = t};
    struct population p;
    enum status st = train_begin(t, &p, e);

    if (st != ST_OK)
        return st;
    st = learn_scans(&w, &p, out, r, e);
    if (st == ST_OK)
        st = to_model(&p, out, e);
    free(w.sample);
    free(w.gap);
    free(w.first);
    free(w.pair);
    population_free(&p);
    return st;
}

/* ---- the calibration */

static enum status read_scores(const char *path, struct rates **out, struct errinfo *e)
{
    struct rates_score *s = NULL;
    void *larger;
    size_t n = 0;
    int type = -1, score = -1;
    struct csv *csv;
    bool more = false;
    enum status st = csv_open(path, false, &csv, e);

    *out = NULL;
    if (st != ST_OK)
        return st;
    if ((st = csv_need(csv, "comparison", &type, e)) == ST_OK)
        st = csv_need(csv, "score", &score, e);
    while (st == ST_OK && (st = csv_next(csv, &more, e)) == ST_OK && more) {
        /* A comparison with a scan that was refused has no score. */
        if (strcmp(csv_field(csv, type), "non-mated") != 0 ||
            csv_field(csv, score)[0] == '\0')
            continue;
        if ((larger = command_grow(s, n, sizeof *s)) == NULL) {
            st = errinfo_memory(e);
            break;
        }
        s = larger;
        s[n] = (struct rates_score){0, 0, 1};
        st = csv_number(csv, score, &s[n++].score, e);
    }
    csv_close(csv);
    if (st == ST_OK && (st = rates_new(s, n, 2, out)) != ST_OK)
        (void)errinfo_set(e, st, "%.160s: %s", path, status_message(st));
    free(s);
    return st;
}

static enum status calibrate(const char *path, struct surface_model *m, struct errinfo *e)
{
    struct surface_calibration c;
    struct rates *r;
    enum status st = read_scores(path, &r, e);

    if (st != ST_OK)
        return st;
    st = rates_calibrate(r, CALIBRATED_FMR, &c);
    if (st == ST_OK)
        m->calibration = c;
    else
        (void)errinfo_set(
            e, st,
            "%.160s: %zu non-mated scores are too few for a false match rate of "
            "%g %%: %zu are needed",
            path, rates_nimpostor(r), 100 * CALIBRATED_FMR, rates_needed(CALIBRATED_FMR));
    rates_free(r);
    return st == ST_OK ? round_model(m, e) : st;
}

enum status train_model(const struct train *t, const char *name,
                        struct surface_model *out, struct train_report *report_out,
                        struct errinfo *e)
{
    enum status st = ST_OK;

    memset(report_out, 0, sizeof *report_out);
    *out = *t->base;
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    if (t->corpus != NULL)
        st = learn(t, out, report_out, e);
    return st == ST_OK && t->scores != NULL ? calibrate(t->scores, out, e) : st;
}
