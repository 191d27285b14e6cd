#include "surfacectl_trials.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define SEED    UINT64_C(19795) /* the standard's number */
#define THREADS 256

static const double pi = 3.14159265358979323846;

static double clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* ---- what is compared */

/* A growing list of comparisons. */
struct plan {
    struct surfacectl_trial *trial;
    size_t n, room;
};

static bool plan_add(struct plan *p, uint32_t template, uint32_t probe,
                     enum corpus_pair type)
{
    if (p->n == p->room) {
        const size_t room = p->room > 0 ? 2 * p->room : 4096;
        void *larger = realloc(p->trial, room * sizeof *p->trial);

        if (larger == NULL)
            return false;
        p->trial = larger;
        p->room = room;
    }
    p->trial[p->n++] = (struct surfacectl_trial){
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
static bool plan_probe(struct plan *p, const struct corpus *c, uint32_t probe,
                       uint32_t impostors, uint32_t *list)
{
    const uint32_t subject = c->scan[probe].subject;
    uint64_t seed = SEED + ((uint64_t)probe << 32);
    uint32_t m = 0;
    bool ok = plan_add(p, c->subject[subject].enrolled, probe, CORPUS_GENUINE);

    for (uint32_t s = 0; s < c->nsubject && ok; s++) {
        const enum corpus_pair type = corpus_pair(c, s, subject);

        if (type == CORPUS_RELATIVE)
            ok = plan_add(p, c->subject[s].enrolled, probe, type);
        else if (type == CORPUS_IMPOSTOR)
            list[m++] = c->subject[s].enrolled;
    }
    m = draw(list, m, impostors < m ? impostors : m, rates_random(&seed));
    for (uint32_t i = 0; i < m && ok; i++)
        ok = plan_add(p, list[i], probe, CORPUS_IMPOSTOR);
    return ok;
}

/* How many impostors of each probe keep the sum below the limit; UINT32_MAX: all of them. */
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
    if (all <= SURFACECTL_TRIALS_IMPOSTORS)
        return UINT32_MAX;
    return nprobe < SURFACECTL_TRIALS_IMPOSTORS ? SURFACECTL_TRIALS_IMPOSTORS / nprobe
                                                : 1;
}

static enum status plan_all(struct surfacectl_trials *t)
{
    const struct corpus *c = t->corpus;
    uint32_t *list = malloc(c->nsubject * sizeof *list);
    struct plan p = {0};
    bool ok = list != NULL && t->impostors > 0;

    for (uint32_t i = 0; i < c->nscan && ok; i++)
        if (!c->scan[i].enrolled)
            ok = plan_probe(&p, c, i, t->impostors, list);
    free(list);
    t->trial = p.trial;
    t->n = p.n;
    return ok ? ST_OK : ST_ENOMEM;
}

/* ---- doing it */

struct run;

/* What a thread works with. */
struct worker {
    struct run *run;
    struct surfacectl c; /* units, threshold, and its own error */
    struct face_work *w;
    struct face probe;
};

struct run {
    struct surfacectl_trials *t;
    struct surfacectl *c;
    const struct surfacectl_trials_options *o;
    struct face *template; /* [nsubject] */
    /* An item is a subject to enroll or the comparisons of a probe. */
    enum status (*item)(struct worker *w, size_t i, size_t *weight);
    size_t *first; /* the comparisons of item i: first[i] .. first[i + 1] - 1 */
    pthread_mutex_t lock;
    size_t nitem, next, done, total; /* under the lock, and what follows */
    double shown_ms;
    const char *what;
    bool terminal;
    enum status st;
};

static void show_progress(struct run *r, bool last)
{
    const double now = clock_ms();
    const int width = 40;
    const int bar =
        r->total > 0 ? (int)(width * (double)r->done / (double)r->total) : width;

    if (!r->terminal || (!last && now - r->shown_ms < 100))
        return;
    r->shown_ms = now;
    (void)fprintf(stderr, "\r%-9s [%.*s%*s] %zu of %zu%s", r->what, bar,
                  "########################################", width - bar, "", r->done,
                  r->total, last ? "\n" : "");
    (void)fflush(stderr);
}

/* A model of a scan; why there can be none is kept. */
static enum status build(struct worker *w, uint32_t scan, struct face *out)
{
    struct surfacectl_trials *t = w->run->t;
    enum status st = surfacectl_scan_read(&w->c, t->corpus->scan[scan].path, w->w, out);

    if (st == ST_OK || st == ST_ENOMEM || st == ST_EIO || st == ST_ENOTFOUND)
        return st;
    t->refused[scan] = strdup(w->c.e.msg);
    return t->refused[scan] != NULL ? ST_OK : ST_ENOMEM;
}

static enum status enroll_item(struct worker *w, size_t i, size_t *weight)
{
    *weight = 1;
    return build(w, w->run->t->corpus->subject[i].enrolled, &w->run->template[i]);
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

/* Degrees between the rotation found, probe to template, and the true one. */
static double angle(const struct corpus_scan *template, const struct corpus_scan *probe,
                    const double transform[16])
{
    double p[9], e[9], trace = 0;

    rotation(probe, p);
    rotation(template, e);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                trace += transform[4 * i + j] * e[3 * i + k] * p[3 * j + k];
    trace = fmax(-1, fmin(1, (trace - 1) / 2));
    return acos(trace) * 180 / pi;
}

static enum status compare(struct worker *w, struct surfacectl_trial *x)
{
    const struct corpus *c = w->run->t->corpus;
    const struct corpus_scan *template = &c->scan[x->template],
                             *probe = &c->scan[x->probe];
    struct face_result r;
    const enum status st = face_compare(&w->run->template[template->subject], &w -> probe,
                                        w -> c.threshold_mm, clock_ms, w->w, &r);

    if (st != ST_OK)
        return errinfo_set(&w->c.e, st, "%.120s with %.80s: %s", probe->file,
                           template->file, status_message(st));
    x->done = true;
    x->decision = r.decision;
    x->disparity_mm = r.disparity_mm;
    x->threshold_mm = r.threshold_mm;
    x->fmr_at_score = r.fmr_at_score;
    x->overlap = r.measure.overlap;
    x->weight_overlap = r.weight_overlap;
    x->align_ms = r.align_ms;
    x->measure_ms = r.measure_ms;
    if (c->posed && x->type == CORPUS_GENUINE)
        x->rotation_deg = angle(template, probe, r.align.transform);
    return ST_OK;
}

static enum status probe_item(struct worker *w, size_t i, size_t *weight)
{
    struct surfacectl_trials *t = w->run->t;
    const size_t first = w->run->first[i], end = w->run->first[i + 1];
    const uint32_t scan = t->trial[first].probe;
    enum status st = build(w, scan, &w->probe);

    *weight = end - first;
    for (size_t k = first; k < end && st == ST_OK && t->refused[scan] == NULL; k++)
        if (t->refused[t->trial[k].template] == NULL)
            st = compare(w, &t->trial[k]);
    return st;
}

static void *work(void *arg)
{
    struct worker *w = arg;
    struct run *r = w->run;

    (void)pthread_mutex_lock(&r->lock);
    while (r->st == ST_OK && r->next < r->nitem) {
        const size_t i = r->next++;
        size_t weight = 0;
        enum status st;

        (void)pthread_mutex_unlock(&r->lock);
        st = r->item(w, i, &weight);
        (void)pthread_mutex_lock(&r->lock);
        if (st != ST_OK && r->st == ST_OK) {
            r->st = st;
            r->c->e = w->c.e;
            r->c->e.code = st;
        }
        r->done += weight;
        show_progress(r, false);
    }
    (void)pthread_mutex_unlock(&r->lock);
    return NULL;
}

/* All items by all workers; the caller is one of them. */
static enum status run_items(struct run *r, struct worker *workers, const char *what,
                             enum status (*item)(struct worker *, size_t, size_t *),
                             size_t nitem, size_t total)
{
    pthread_t thread[THREADS];
    uint32_t n = 1;

    r->item = item;
    r->nitem = nitem;
    r->next = r->done = 0;
    r->total = total;
    r->what = what;
    while (n < r->t->nthread && pthread_create(&thread[n], NULL, work, &workers[n]) == 0)
        n++; /* fewer threads than wished for do too */
    (void)work(&workers[0]);
    for (uint32_t i = 1; i < n; i++)
        (void)pthread_join(thread[i], NULL);
    if (nitem > 0 && r->st == ST_OK)
        show_progress(r, true);
    else if (r->terminal && nitem > 0)
        (void)fputc('\n', stderr);
    return r->st;
}

/* Where each probe's comparisons begin; their number in *n. */
static enum status find_items(struct run *r, size_t *n)
{
    const struct surfacectl_trials *t = r->t;

    *n = 0;
    if ((r->first = malloc((t->corpus->nscan + (size_t)1) * sizeof *r->first)) == NULL)
        return ST_ENOMEM;
    for (size_t i = 0; i < t->n; i++)
        if (i == 0 || t->trial[i].probe != t->trial[i - 1].probe)
            r->first[(*n)++] = i;
    r->first[*n] = t->n;
    return ST_OK;
}

static enum status run_all(struct run *r, struct worker *workers)
{
    struct surfacectl_trials *t = r->t;
    const double start = clock_ms();
    size_t nprobe;
    enum status st = find_items(r, &nprobe);

    for (uint32_t i = 0; i < t->nthread && st == ST_OK; i++) {
        workers[i].run = r;
        workers[i].c.units = r->c->units;
        workers[i].c.threshold_mm = r->c->threshold_mm;
        if ((workers[i].w = face_work_new(r->o->model)) == NULL)
            st = ST_ENOMEM;
        else if (r->o->decision != NULL)
            face_work_decide(workers[i].w, r->o->decision);
    }
    if (st != ST_OK)
        return errinfo_set(&r->c->e, st, "the comparisons: %s", status_message(st));
    st = run_items(r, workers, "enrolling", enroll_item, t->corpus->nsubject,
                   t->corpus->nsubject);
    t->build_s = (clock_ms() - start) / 1e3;
    if (st == ST_OK)
        st = run_items(r, workers, "comparing", probe_item, nprobe, t->n);
    t->compare_s = (clock_ms() - start) / 1e3 - t->build_s;
    return st;
}

static uint32_t thread_count(uint32_t wanted)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);

    if (wanted == 0)
        wanted = cores > 0 ? (uint32_t)cores : 1;
    return wanted < THREADS ? wanted : THREADS;
}

enum status surfacectl_trials_run(struct surfacectl *c, const struct corpus *corpus,
                                  const struct surfacectl_trials_options *o,
                                  struct surfacectl_trials **out)
{
    struct surfacectl_trials *t = calloc(1, sizeof *t);
    struct run r = {.t = t, .c = c, .o = o, .terminal = isatty(STDERR_FILENO) == 1};
    struct worker *workers = NULL;
    enum status st = ST_ENOMEM;

    *out = NULL;
    (void)pthread_mutex_init(&r.lock, NULL);
    if (t != NULL) {
        t->corpus = corpus;
        t->seed = SEED;
        t->nthread = thread_count(o->threads);
        t->impostors = o->impostors > 0 ? o->impostors : share(corpus);
        t->refused = calloc(corpus->nscan, sizeof *t->refused);
        workers = calloc(t->nthread, sizeof *workers);
        r.template = calloc(corpus->nsubject, sizeof *r.template);
    }
    if (t == NULL || workers == NULL || t->refused == NULL || r.template == NULL ||
        plan_all(t) != ST_OK)
        (void)errinfo_set(&c->e, st, "the comparisons: out of memory");
    else
        st = run_all(&r, workers);
    for (uint32_t i = 0; workers != NULL && i < t->nthread; i++) {
        face_free(&workers[i].probe);
        face_work_free(workers[i].w);
    }
    for (uint32_t i = 0; r.template != NULL && i < corpus->nsubject; i++)
        face_free(&r.template[i]);
    free(workers);
    free(r.template);
    free(r.first);
    (void)pthread_mutex_destroy(&r.lock);
    if (st == ST_OK)
        *out = t;
    else
        surfacectl_trials_free(t);
    return st;
}

void surfacectl_trials_free(struct surfacectl_trials *t)
{
    if (t == NULL)
        return;
    for (uint32_t i = 0; t->refused != NULL && i < t->corpus->nscan; i++)
        free(t->refused[i]);
    free(t->refused);
    free(t->trial);
    free(t);
}
