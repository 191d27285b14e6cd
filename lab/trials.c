#include "trials.h"

#include <math.h>
#include <stdlib.h>

#include "model.h"
#include "pool.h"
#include "rates.h"

/* ---- what is compared */

static bool plan_add(struct trials *t, uint32_t template, uint32_t probe,
                     enum corpus_pair type)
{
    struct trial *larger = command_grow(t->trial, t->n, sizeof *t->trial), *x;

    if (larger == NULL)
        return false;
    t->trial = larger;
    x = &t->trial[t->n++];
    *x = (struct trial){
        .template = template, .probe = probe, .type = type, .disparity_mm = NAN};
    for (int i = 0; i < SURFACE_REGIONS; i++)
        x->region[i] = NAN;
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
static bool plan_probe(struct trials *t, uint32_t probe, uint32_t *list)
{
    const struct corpus *c = t->corpus;
    const uint32_t subject = c->scan[probe].subject;
    uint64_t seed = TRIALS_SEED + ((uint64_t)probe << 32);
    uint32_t m = 0;
    bool ok = c->subject[subject].enrolled == CORPUS_NONE ||
              plan_add(t, c->subject[subject].enrolled, probe, CORPUS_GENUINE);

    for (uint32_t s = 0; s < c->nsubject && ok; s++) {
        const enum corpus_pair type = corpus_pair(c, s, subject);

        if (c->subject[s].enrolled == CORPUS_NONE)
            continue;
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

/* How many non-mated comparisons of each probe keep the sum below the limit, or all; 0: out of
 * memory. */
static uint32_t trials_share(const struct corpus *c)
{
    uint32_t *size = calloc(c->npopulation, sizeof *size);
    uint32_t nprobe = 0;
    double all = 0;

    if (size == NULL)
        return 0;
    for (uint32_t i = 0; i < c->nsubject; i++)
        size[c->subject[i].population] += c->subject[i].enrolled != CORPUS_NONE;
    for (uint32_t i = 0; i < c->nscan; i++)
        if (!c->scan[i].enrolled) {
            const struct corpus_subject *s = &c->subject[c->scan[i].subject];

            nprobe++;
            all += size[s->population] - (s->enrolled != CORPUS_NONE);
        }
    free(size);
    if (all <= TRIALS_NON_MATED)
        return TRIALS_ALL;
    return nprobe < TRIALS_NON_MATED ? TRIALS_NON_MATED / nprobe : 1;
}

static bool plan_listed(struct trials *t)
{
    const struct corpus *c = t->corpus;
    bool ok = true;

    for (size_t i = 0; i < c->nlisted && ok; i++) {
        const uint32_t template = c->listed[i].template, probe = c->listed[i].probe;

        ok = plan_add(t, template, probe,
                      corpus_pair(c, c->scan[template].subject, c->scan[probe].subject));
    }
    return ok;
}

static enum status plan_all(struct trials *t)
{
    const struct corpus *c = t->corpus;
    uint32_t *list = malloc(c->nsubject * sizeof *list);
    bool ok = list != NULL && t->non_mated > 0;

    if (ok && c->nlisted > 0)
        ok = plan_listed(t);
    for (uint32_t i = 0; i < c->nscan && ok && c->nlisted == 0; i++) {
        if (c->scan[i].enrolled)
            t->template[i].used = true; /* also where nothing is compared with it */
        else
            ok = plan_probe(t, i, list);
    }
    for (size_t i = 0; i < t->n; i++) {
        t->template[t->trial[i].template].used = true;
        t->probe[t->trial[i].probe].used = true;
    }
    free(list);
    return ok ? ST_OK : ST_ENOMEM;
}

/* ---- doing it */

struct run {
    struct trials *t;
    const struct lab *c;
    uint32_t *templates;           /* [ntemplate] of corpus.scan */
    uint32_t *slot;                /* [nscan] a template's place among them */
    struct surface_face *template; /* [ntemplate] */
    size_t ntemplate;
    size_t *order; /* the comparisons by probe, as many as there are */
    size_t *first; /* those of item i: order[first[i]] .. order[first[i + 1] - 1] */
    size_t nprobe; /* items */
};

static enum status trials_build(const struct run *r, uint32_t scan, bool enrolment,
                                struct surface_work *w, struct surface_face *out,
                                struct errinfo *e)
{
    struct surface_found found;
    struct trials_scan *s = enrolment ? &r->t->template[scan] : &r->t->probe[scan];

    return lab_scan_of(r->c, &r->t->corpus->scan[scan], enrolment, w, out, &found, &s->st,
                       &s->why, e);
}

static enum status enroll_item(void *arg, size_t i, struct surface_work *w,
                               struct errinfo *e)
{
    const struct run *r = arg;

    return trials_build(r, r->templates[i], true, w, &r->template[i], e);
}

static enum status trials_compare(const struct run *r, const struct surface_face *face,
                                  struct surface_work *w, struct trial *x,
                                  struct errinfo *e)
{
    const struct corpus *c = r->t->corpus;
    const struct corpus_scan *template = &c->scan[x->template],
                             *probe = &c->scan[x->probe];
    const struct surface_face *own = &r->template[r->slot[x->template]];
    struct surface_comparison f;
    struct surface_disparity least;
    struct surface_parts parts;
    const double start = command_clock_ms();
    enum status st = status_from(surface_compare(w, own, face, &f));

    f.threshold = r->t->threshold;
    surface_best_of(w, 1, &f);
    if (st == ST_OK)
        st = status_from(surface_compare_again(w, own, face, &f));
    x->score_ms = (float)(command_clock_ms() - start);
    if (st == ST_OK && r->c->regions)
        st = status_from(surface_parts(w, own, face, &parts));
    if (st == ST_OK && r->c->minimal)
        st = status_from(surface_disparity(w, own, face, &least));
    if (st != ST_OK)
        return errinfo_set(e, st, "%.120s with %.80s: %s", probe->file, template->file,
                           status_message(st));
    x->done = true;
    x->decision = f.decision;
    x->score = f.score;
    x->fmr_at_score = f.false_match_rate;
    x->overlap = (float)f.overlap;
    for (int i = 0; i < SURFACE_REGIONS && r->c->regions; i++)
        x->region[i] = (float)parts.region[i];
    if (r->c->minimal)
        x->disparity_mm = (float)least.disparity_mm;
    return ST_OK;
}

static enum status probe_item(void *arg, size_t i, struct surface_work *w,
                              struct errinfo *e)
{
    const struct run *r = arg;
    struct trials *t = r->t;
    const uint32_t scan = t->trial[r->order[r->first[i]]].probe;
    struct surface_face face = {.quality = {0}};
    enum status st = trials_build(r, scan, false, w, &face, e);

    for (size_t k = r->first[i]; k < r->first[i + 1] && st == ST_OK; k++) {
        struct trial *x = &t->trial[r->order[k]];

        if (t->probe[scan].st == ST_OK && t->template[x->template].st == ST_OK)
            st = trials_compare(r, &face, w, x, e);
    }
    face_free(&face);
    return st;
}

/* The templates, and each probe's comparisons in their order. */
static enum status find_items(struct run *r)
{
    const struct trials *t = r->t;
    const uint32_t nscan = t->corpus->nscan;
    size_t *at = calloc(nscan + (size_t)1, sizeof *at); /* where a probe's begin */
    size_t begin = 0;

    r->templates = malloc(nscan * sizeof *r->templates);
    r->slot = malloc(nscan * sizeof *r->slot);
    r->order = malloc((t->n + 1) * sizeof *r->order);
    r->first = malloc((nscan + (size_t)1) * sizeof *r->first);
    if (at == NULL || r->templates == NULL || r->slot == NULL || r->order == NULL ||
        r->first == NULL) {
        free(at);
        return ST_ENOMEM;
    }
    for (size_t i = 0; i < t->n; i++)
        at[t->trial[i].probe]++;
    for (uint32_t i = 0; i < nscan; i++) {
        const size_t n = at[i];

        at[i] = begin;
        if (n > 0)
            r->first[r->nprobe++] = begin;
        begin += n;
        r->slot[i] = (uint32_t)r->ntemplate;
        if (t->template[i].used)
            r->templates[r->ntemplate++] = i;
    }
    r->first[r->nprobe] = t->n;
    for (size_t i = 0; i < t->n; i++)
        r->order[at[t->trial[i].probe]++] = i;
    free(at);
    r->template = calloc(r->ntemplate + 1, sizeof *r->template);
    return r->template != NULL ? ST_OK : ST_ENOMEM;
}

static enum status run_all(struct run *r, struct errinfo *e)
{
    struct trials *t = r->t;
    const double start = command_clock_ms();
    enum status st = find_items(r);

    if (st != ST_OK)
        return errinfo_set(e, st, "the comparisons: %s", status_message(st));
    st = pool_run("enrolling", t->nthread, r->c->model, r->ntemplate, enroll_item, r, e);
    t->build_s = (command_clock_ms() - start) / 1e3;
    if (st == ST_OK)
        st = pool_run("comparing", t->nthread, r->c->model, r->nprobe, probe_item, r, e);
    t->compare_s = (command_clock_ms() - start) / 1e3 - t->build_s;
    return st;
}

enum status trials_run(struct lab *c, const struct corpus *corpus, struct trials **out)
{
    struct trials *t = calloc(1, sizeof *t);
    struct run r = {.t = t, .c = c};
    enum status st = ST_ENOMEM;

    *out = NULL;
    if (t != NULL) {
        t->corpus = corpus;
        t->threshold =
            isnan(c->threshold) ? c->model->calibration.threshold : c->threshold;
        t->nthread = pool_threads(c->threads);
        t->non_mated = corpus->nlisted > 0 ? TRIALS_ALL
                       : c->non_mated > 0  ? c->non_mated
                       : c->matrix         ? TRIALS_ALL
                                           : trials_share(corpus);
        t->template = calloc(corpus->nscan, sizeof *t->template);
        t->probe = calloc(corpus->nscan, sizeof *t->probe);
    }
    if (t == NULL || t->template == NULL || t->probe == NULL || plan_all(t) != ST_OK)
        (void)errinfo_set(&c->e, st, "the comparisons: out of memory");
    else
        st = run_all(&r, &c->e);
    for (size_t i = 0; r.template != NULL && i < r.ntemplate; i++)
        face_free(&r.template[i]);
    free(r.template);
    free(r.templates);
    free(r.slot);
    free(r.order);
    free(r.first);
    if (st == ST_OK)
        *out = t;
    else
        trials_free(t);
    return st;
}

void trials_free(struct trials *t)
{
    if (t == NULL)
        return;
    for (uint32_t i = 0; i < t->corpus->nscan; i++) {
        if (t->template != NULL)
            free(t->template[i].why);
        if (t->probe != NULL)
            free(t->probe[i].why);
    }
    free(t->template);
    free(t->probe);
    free(t->trial);
    free(t);
}
