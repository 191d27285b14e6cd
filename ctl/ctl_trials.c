#include "ctl_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"
#include "pool.h"
#include "ctl_corpus.h"

#define SEED UINT64_C(19795) /* the standard's number */

static const double pi = 3.14159265358979323846;

/* ---- what is compared */

static bool plan_add(struct ctl_trials *t, uint32_t template, uint32_t probe,
                     enum corpus_pair type)
{
    struct ctl_trial *larger = ctl_grow(t->trial, t->n, sizeof *t->trial);

    if (larger == NULL)
        return false;
    t->trial = larger;
    t->trial[t->n++] = (struct ctl_trial){
        .template = template, .probe = probe, .type = type, .rotation_deg = (double)NAN};
    return true;
}

/* n of list[0..m-1], in their order, drawn without replacement: those are moved to the
 * front (Knuth's algorithm S). */
static uint32_t draw(uint32_t *list, uint32_t m, uint32_t n, uint64_t seed)
{
    uint32_t taken = 0;

    for (uint32_t i = 0; i < m && taken < n; i++)
        if (rates_below(&seed, m - i) < n - taken)
            list[taken++] = list[i];
    return taken;
}

/* The comparisons of one probe: its own template, close relatives', others'. */
static bool plan_probe(struct ctl_trials *t, uint32_t probe, uint32_t *list)
{
    const struct corpus *c = t->corpus;
    const uint32_t subject = c->scan[probe].subject;
    uint64_t seed = SEED + ((uint64_t)probe << 32);
    uint32_t m = 0;
    bool ok = plan_add(t, c->subject[subject].enrolled, probe, CORPUS_GENUINE);

    for (uint32_t s = 0; s < c->nsubject && ok; s++) {
        const enum corpus_pair type = corpus_pair(c, s, subject);

        if (type == CORPUS_RELATIVE)
            ok = plan_add(t, c->subject[s].enrolled, probe, type);
        else if (type == CORPUS_IMPOSTOR)
            list[m++] = c->subject[s].enrolled;
    }
    m = draw(list, m, t->non_mated < m ? t->non_mated : m, rates_random(&seed));
    for (uint32_t i = 0; i < m && ok; i++)
        ok = plan_add(t, list[i], probe, CORPUS_IMPOSTOR);
    return ok;
}

/* How many non-mated comparisons of each probe keep the sum below the limit; UINT32_MAX: all of them. */
static uint32_t share(const struct corpus *c)
{
    uint32_t *size = calloc(c->npopulation, sizeof *size);
    uint32_t nprobe = 0;
    double all = 0;

    if (size == NULL)
        return 0;
    for (uint32_t i = 0; i < c->nsubject; i++)
        size[c->subject[i].population]++;
    for (uint32_t i = 0; i < c->nscan; i++)
        if (!c->scan[i].enrolled) {
            nprobe++;
            all += size[c->subject[c->scan[i].subject].population] - 1;
        }
    free(size);
    if (all <= CTL_TRIALS_NON_MATED)
        return UINT32_MAX;
    return nprobe < CTL_TRIALS_NON_MATED ? CTL_TRIALS_NON_MATED / nprobe : 1;
}

static enum status plan_all(struct ctl_trials *t)
{
    const struct corpus *c = t->corpus;
    uint32_t *list = malloc(c->nsubject * sizeof *list);
    bool ok = list != NULL && t->non_mated > 0;

    for (uint32_t i = 0; i < c->nscan && ok; i++)
        if (!c->scan[i].enrolled)
            ok = plan_probe(t, i, list);
    free(list);
    return ok ? ST_OK : ST_ENOMEM;
}

/* ---- doing it */

struct sample {
    struct face face;
    struct scan_found found;
};

struct run {
    struct ctl_trials *t;
    const struct ctl *c;
    const struct decision *decision; /* NULL: the model's */
    struct sample *template;         /* [nsubject] */
    size_t *first; /* the comparisons of item i: first[i] .. first[i + 1] - 1 */
};

static enum status build(const struct run *r, uint32_t scan, struct face_work *w,
                         struct sample *out, struct errinfo *e)
{
    const struct corpus_scan *s = &r->t->corpus->scan[scan];

    return ctl_corpus_face(r->c, s, s->enrolled, w, &out->face, &out->found,
                           &r->t->refused[scan], e);
}

static enum status enroll_item(void *arg, size_t i, struct face_work *w,
                               struct errinfo *e)
{
    const struct run *r = arg;

    return build(r, r->t->corpus->subject[i].enrolled, w, &r->template[i], e);
}

/* rotation(s, r): Rz Rx Ry. */
static void rotation(const struct corpus_scan *s, double r[9])
{
    const double y = s->pose[0] * pi / 180, x = s->pose[1] * pi / 180,
                 z = s->pose[2] * pi / 180;
    const double cy = cos(y), sy = sin(y), cx = cos(x), sx = sin(x), cz = cos(z),
                 sz = sin(z);
    const double m[9] = {cz * cy - sz * sx * sy,
                         -sz * cx,
                         cz * sy + sz * sx * cy,
                         sz * cy + cz * sx * sy,
                         cz * cx,
                         sz * sy - cz * sx * cy,
                         -cx * sy,
                         sx,
                         cx * cy};

    memcpy(r, m, sizeof m);
}

/* The pose of a scan (rotation()) in the view that its points were brought into. */
static void viewed(const struct corpus_scan *scan, const struct scan_found *found,
                   double r[9])
{
    const double *v = found->view, unit = found->unit_mm;
    double s[9];

    rotation(scan, s);
    for (int i = 0; i < 9; i++) {
        r[i] = 0;
        for (int k = 0; k < 3; k++)
            r[i] += v[4 * (i / 3) + k] / unit * s[3 * k + i % 3];
    }
}

/* Degrees between the rotation found, probe to template, and the true one. */
static double angle(const struct corpus_scan *template,
                    const struct scan_found *of_template, const struct corpus_scan *probe,
                    const struct scan_found *of_probe, const double transform[16])
{
    double p[9], e[9], trace = 0;

    viewed(probe, of_probe, p);
    viewed(template, of_template, e);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                trace += transform[4 * i + j] * e[3 * i + k] * p[3 * j + k];
    trace = fmax(-1, fmin(1, (trace - 1) / 2));
    return acos(trace) * 180 / pi;
}

static enum status compare(const struct run *r, const struct sample *sample,
                           struct face_work *w, struct ctl_trial *x, struct errinfo *e)
{
    const struct corpus *c = r->t->corpus;
    const struct corpus_scan *template = &c->scan[x->template],
                             *probe = &c->scan[x->probe];
    struct face_result f;
    const struct sample *own = &r->template[template->subject];
    const enum status st =
        face_compare(&own->face, &sample->face, r->c->threshold_mm, ctl_clock_ms, w, &f);

    if (st != ST_OK)
        return errinfo_set(e, st, "%.120s with %.80s: %s", probe->file, template->file,
                           status_message(st));
    x->done = true;
    x->decision = f.decision;
    x->comparable = f.comparable;
    x->score_mm = f.score_mm;
    x->threshold_mm = f.threshold_mm;
    x->calibrated_mm = f.calibrated_mm;
    x->fmr_at_score = f.fmr_at_score;
    x->overlap = f.overlap;
    x->weight_overlap = f.weight_overlap;
    x->align_ms = f.align_ms;
    x->measure_ms = f.measure_ms;
    if (c->posed && x->type == CORPUS_GENUINE)
        x->rotation_deg =
            angle(template, &own->found, probe, &sample->found, f.align.transform);
    return ST_OK;
}

static enum status probe_item(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    const struct run *r = arg;
    struct ctl_trials *t = r->t;
    const uint32_t scan = t->trial[r->first[i]].probe;
    struct sample sample = {.face = {.quality = {0}}};
    enum status st = build(r, scan, w, &sample, e);

    if (r->decision != NULL)
        face_work_decide(w, r->decision);
    for (size_t k = r->first[i]; k < r->first[i + 1] && st == ST_OK; k++)
        if (t->refused[scan] == NULL && t->refused[t->trial[k].template] == NULL)
            st = compare(r, &sample, w, &t->trial[k], e);
    face_free(&sample.face);
    return st;
}

/* Where each probe's comparisons begin; their number in *n. */
static enum status find_items(struct run *r, size_t *n)
{
    const struct ctl_trials *t = r->t;

    *n = 0;
    if ((r->first = malloc((t->corpus->nscan + (size_t)1) * sizeof *r->first)) == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < t->n; i++)
        if (i == 0 || t->trial[i].probe != t->trial[i - 1].probe)
            r->first[(*n)++] = i;
    r->first[*n] = t->n;
    return ST_OK;
}

static enum status run_all(struct run *r, struct errinfo *e)
{
    struct ctl_trials *t = r->t;
    const double start = ctl_clock_ms();
    size_t nprobe;
    enum status st = find_items(r, &nprobe);

    if (st != ST_OK)
        return errinfo_set(e, st, "the comparisons: %s", status_message(st));
    st = pool_run("enrolling", t->nthread, r->c->model, t->corpus->nsubject, enroll_item,
                  r, e);
    t->build_s = (ctl_clock_ms() - start) / 1e3;
    if (st == ST_OK)
        st = pool_run("comparing", t->nthread, r->c->model, nprobe, probe_item, r, e);
    t->compare_s = (ctl_clock_ms() - start) / 1e3 - t->build_s;
    return st;
}

enum status ctl_trials_run(struct ctl *c, const struct corpus *corpus,
                           const struct decision *decision, uint32_t non_mated,
                           struct ctl_trials **out)
{
    struct ctl_trials *t = calloc(1, sizeof *t);
    struct run r = {.t = t, .c = c, .decision = decision};
    enum status st = ST_ENOMEM;

    *out = NULL;
    if (t != NULL) {
        t->corpus = corpus;
        t->threshold_mm = c->threshold_mm > 0 ? c->threshold_mm
                          : decision != NULL  ? decision->threshold_mm
                                              : c->model->decision.threshold_mm;
        t->seed = SEED;
        t->nthread = pool_threads(c->threads);
        t->non_mated = non_mated > 0 ? non_mated : share(corpus);
        t->refused = calloc(corpus->nscan, sizeof *t->refused);
        r.template = calloc(corpus->nsubject, sizeof *r.template);
    }
    if (t == NULL || t->refused == NULL || r.template == NULL || plan_all(t) != ST_OK)
        (void)errinfo_set(&c->e, st, "the comparisons: out of memory");
    else
        st = run_all(&r, &c->e);
    for (uint32_t i = 0; r.template != NULL && i < corpus->nsubject; i++)
        face_free(&r.template[i].face);
    free(r.template);
    free(r.first);
    if (st == ST_OK)
        *out = t;
    else
        ctl_trials_free(t);
    return st;
}

void ctl_trials_free(struct ctl_trials *t)
{
    if (t == NULL)
        return;
    for (uint32_t i = 0; t->refused != NULL && i < t->corpus->nscan; i++)
        free(t->refused[i]);
    free(t->refused);
    free(t->trial);
    free(t);
}
