/* The command dedup: the same face under two subjects. */
#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store.h"
#include "pool.h"
#include "ctl_command.h"
#include "ctl_cross.h"
#include "ctl_model.h"

#define NOBODY UINT32_MAX

static const char *only;                      /* --subject */
static double chosen_threshold = (double)NAN; /* --threshold */

/* A comparison of two subjects' templates. */
struct ctl_dedup_pair {
    uint32_t x, y; /* two subjects, in their order */
    uint32_t a, b; /* a template of each */
    double score;
};

struct dedup {
    struct ctl *c;
    struct ctl_cross all;
    uint32_t alone; /* the subject that is compared with all others; or NOBODY */

    struct store_calibration calibration; /* the calibration in force */
    double threshold;
    double pairs; /* pairs of templates to compare */

    pthread_mutex_t lock; /* protects the following members */
    struct ctl_dedup_pair *
        found; /* [nfound]; in the end the pair with the highest score of each two subjects */
    size_t nfound;
    uint64_t compared, inconclusive;
};

/* ---- templates that are compared */

static enum status list_all(struct dedup *d)
{
    enum status st = ctl_cross_list(d->c, &d->all);

    d->alone = NOBODY;
    for (uint32_t i = 0; only != NULL && i < d->all.nsubject; i++)
        if (strcmp(d->all.subject[i].id, only) == 0)
            d->alone = i;
    if (st == ST_OK && only != NULL && d->alone == NOBODY)
        st =
            errinfo_set(&d->c->e, ST_ENOTFOUND, "no subject %.128s has a template", only);
    return st;
}

/* Each two once, the one that came first as the template. */
static bool is_pair(const struct dedup *d, uint32_t a, uint32_t b)
{
    const uint32_t x = d->all.tmpl[a].owner, y = d->all.tmpl[b].owner;

    return x < y && (d->alone == NOBODY || x == d->alone || y == d->alone);
}

static void count_pairs(struct dedup *d)
{
    const struct ctl_cross *p = &d->all;

    for (uint32_t i = 0; i < p->nsubject; i++) {
        const struct ctl_cross_subject *one = &p->subject[i];

        if (d->alone == NOBODY)
            d->pairs += (double)one->n * (p->ntemplate - one->first - one->n);
        else if (i == d->alone)
            d->pairs = (double)one->n * (p->ntemplate - one->n);
    }
}

/* ---- comparing */

static enum status ctl_dedup_keep(struct dedup *d, uint32_t a, uint32_t b, double score)
{
    void *larger = command_grow(d->found, d->nfound, sizeof *d->found);

    if (larger == NULL)
        return ST_ENOMEM;
    d->found = larger;
    d->found[d->nfound++] =
        (struct ctl_dedup_pair){d->all.tmpl[a].owner, d->all.tmpl[b].owner, a, b, score};
    return ST_OK;
}

/* Loads the face of template i.  *f is NULL if the template was deleted since, or is of another engine and
 * no face to this one. */
static enum status ctl_dedup_load(const struct dedup *d, uint32_t i,
                                  struct surface_work *w, struct surface_face **f,
                                  struct errinfo *e)
{
    struct store_template t;
    const enum status st =
        store_template_load(d->c->store, d->c->actor, d->all.tmpl[i].id, &t, w, f, e);

    return st == ST_ENOTFOUND || st == ST_EVERSION ? ST_OK : st;
}

struct row { /* a template with all later ones */
    struct surface_face *a, *b;
    uint64_t compared, inconclusive;
};

static enum status ctl_dedup_compare(struct dedup *d, uint32_t a, uint32_t b,
                                     struct surface_work *w, struct row *r,
                                     struct errinfo *e)
{
    struct surface_comparison x = {0};
    enum status st = status_from(surface_compare(w, r->a, r->b, &x));

    if (st != ST_OK)
        return errinfo_set(e, st, "comparing: %s", status_message(st));
    x.threshold = d->threshold;
    surface_best_of(w, 1, &x);
    r->compared++;
    r->inconclusive += x.decision == SURFACE_INCONCLUSIVE;
    if (x.decision != SURFACE_MATCH)
        return ST_OK;
    (void)pthread_mutex_lock(&d->lock);
    st = ctl_dedup_keep(d, a, b, x.score);
    (void)pthread_mutex_unlock(&d->lock);
    return st == ST_OK ? ST_OK : errinfo_set(e, st, "out of memory");
}

/* Loading a template costs a tenth of comparing it, so none but the row's own is kept: memory
 * does not grow with the database. */
static enum status compare_row(struct dedup *d, uint32_t a, struct surface_work *w,
                               struct row *r, struct errinfo *e)
{
    bool loaded = false;
    enum status st = ST_OK;

    for (uint32_t b = a + 1; b < d->all.ntemplate && st == ST_OK; b++) {
        if (!is_pair(d, a, b))
            continue;
        if (!loaded && (st = ctl_dedup_load(d, a, w, &r->a, e)) != ST_OK)
            break;
        loaded = true;
        if (r->a == NULL)
            break;
        if ((st = ctl_dedup_load(d, b, w, &r->b, e)) == ST_OK && r->b != NULL)
            st = ctl_dedup_compare(d, a, b, w, r, e);
    }
    return st;
}

/* Rows from both ends in turns: the first are the longest, and the progress is to be even. */
static enum status do_row(void *arg, size_t i, struct surface_work *w, struct errinfo *e)
{
    struct dedup *d = arg;
    const uint32_t k = (uint32_t)i / 2;
    struct row r = {0};
    const enum status st =
        compare_row(d, i % 2 == 0 ? k : d->all.ntemplate - 1 - k, w, &r, e);

    (void)pthread_mutex_lock(&d->lock);
    d->compared += r.compared;
    d->inconclusive += r.inconclusive;
    (void)pthread_mutex_unlock(&d->lock);
    surface_face_free(r.a);
    surface_face_free(r.b);
    return st;
}

/* ---- output */

static void tell_costs(const struct dedup *d)
{
    const double chance =
        d->pairs * surface_calibration_rate(&d->calibration.table, d->threshold);

    json_text(d->c->out, "engine", d->c->engine);
    json_number(d->c->out, "subjects", d->all.nsubject);
    json_number(d->c->out, "templates", d->all.ntemplate);
    json_number(d->c->out, "pairs", d->pairs);
    json_score(d->c->out, "threshold", d->threshold);
    json_rate(d->c->out, "by_chance", chance);
    json_text(d->c->out, "calibration", d->calibration.shipped ? "shipped" : "database");
    (void)fprintf(stderr,
                  "surfacectl: %.0f comparisons of %" PRIu64
                  " subject%s; by chance about %.2g of them at or above %.2f, by the "
                  "calibration of %s\n",
                  d->pairs, CTL_COUNT(d->all.nsubject), chance, d->threshold,
                  d->calibration.shipped
                      ? "other people: these may be more alike (see surfacectl calibrate)"
                      : "this database");
}

static void tell_pair(const struct dedup *d, const struct ctl_dedup_pair *p)
{
    const struct ctl_cross_template *a = &d->all.tmpl[p->a], *b = &d->all.tmpl[p->b];
    const double fmr = surface_calibration_rate(&d->calibration.table, p->score);
    const bool same = strcmp(a->digest, b->digest) == 0;

    json_object(d->c->out, NULL);
    json_text(d->c->out, "subject_a", d->all.subject[p->x].id);
    json_text(d->c->out, "subject_b", d->all.subject[p->y].id);
    json_text(d->c->out, "template_a", a->id);
    json_text(d->c->out, "template_b", b->id);
    json_score(d->c->out, "score", p->score);
    json_rate(d->c->out, "fmr_at_score", fmr);
    json_flag(d->c->out, "same_scan", same);
    json_close(d->c->out);
    ctl_say(d->c, "%9.2f  %8.1e  %s  %s%s\n", p->score, fmr, d->all.subject[p->x].id,
            d->all.subject[p->y].id, same ? "  (identical scan)" : "");
}

static void tell_found(const struct dedup *d)
{
    if (d->nfound > 0)
        ctl_say(d->c, "%9s  %8s  %s\n", "SCORE", "FMR", "SUBJECTS");
    json_array(d->c->out, "duplicates");
    for (size_t i = 0; i < d->nfound; i++)
        tell_pair(d, &d->found[i]);
    json_close(d->c->out);
    json_number(d->c->out, "compared", (double)d->compared);
    json_number(d->c->out, "inconclusive", (double)d->inconclusive);
    ctl_say(d->c, "%zu pair%s of subjects, by %" PRIu64 " comparisons", d->nfound,
            d->nfound == 1 ? "" : "s", d->compared);
    if (d->inconclusive > 0)
        ctl_say(d->c, ", of which %" PRIu64 " were inconclusive", d->inconclusive);
    ctl_say(d->c, "\n");
    if ((double)d->compared < d->pairs)
        ctl_say(d->c,
                "%.0f were skipped: deleted meanwhile, or made by another engine "
                "(template reencode)\n",
                d->pairs - (double)d->compared);
}

static int by_subjects(const void *p, const void *q)
{
    const struct ctl_dedup_pair *v = p, *w = q;

    if (v->x != w->x)
        return v->x < w->x ? -1 : 1;
    if (v->y != w->y)
        return v->y < w->y ? -1 : 1;
    if (v->score != w->score)
        return v->score > w->score ? -1 : 1;
    return v->a != w->a ? (v->a > w->a) - (v->a < w->a) : (v->b > w->b) - (v->b < w->b);
}

static int by_score(const void *p, const void *q)
{
    const struct ctl_dedup_pair *v = p, *w = q;

    return v->score != w->score ? (v->score < w->score) - (v->score > w->score)
                                : by_subjects(p, q);
}

/* Keeps the highest score of each two subjects, the highest of all first: the list does
 * not depend on the order of the pairs.  Returns how many are left. */
static size_t sort_pairs(struct ctl_dedup_pair *pair, size_t n)
{
    size_t kept = 0;

    if (n == 0)
        return 0;
    qsort(pair, n, sizeof *pair, by_subjects);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || pair[kept - 1].x != pair[i].x || pair[kept - 1].y != pair[i].y)
            pair[kept++] = pair[i];
    qsort(pair, kept, sizeof *pair, by_score);
    return kept;
}

/* ---- the command */

static enum status dedup(struct dedup *d)
{
    struct ctl *c = d->c;
    enum status st;

    if ((st = store_calibration_current(d->c->store, &d->calibration, &c->e)) != ST_OK ||
        (st = list_all(d)) != ST_OK)
        return st;
    d->threshold =
        isnan(chosen_threshold) ? d->calibration.table.threshold : chosen_threshold;
    count_pairs(d);
    tell_costs(d);
    if (c->dry_run)
        return ST_OK;
    if (d->pairs > 0)
        st =
            pool_run("compare", c->threads, c->model, d->all.ntemplate, do_row, d, &c->e);
    if (st != ST_OK)
        return st;
    d->nfound = sort_pairs(d->found, d->nfound);
    tell_found(d);
    return ST_OK;
}

static enum status ctl_dedup_run(struct ctl *c)
{
    struct dedup d = {.c = c};
    enum status st;

    (void)pthread_mutex_init(&d.lock, NULL);
    if ((st = ctl_model_open(c, STORE_READ)) == ST_OK)
        st = dedup(&d);
    c->code = d.nfound > 0 ? EXIT_NO : EXIT_FINE;
    (void)pthread_mutex_destroy(&d.lock);
    ctl_cross_free(&d.all);
    free(d.found);
    return st;
}

const struct ctl_command ctl_dedup = {
    .name = "dedup",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL | CTL_THREADS | CTL_DRY_RUN,
    .options = {CTL_OPTION("subject", "ID", command_text, &only,
                           "compare this subject with the others"),
                CTL_OPTION("threshold", "SCORE", command_score, &chosen_threshold,
                           "use this threshold instead of the calibration's")},
    .exits = {"no duplicates", "duplicates were found"},
    .run = ctl_dedup_run,
    .summary = "find one face enrolled under two subjects",
    .help =
        "Lists pairs of subjects at or above the threshold, highest score first: they may be one\n"
        "person, relatives, or similar by chance. The expected number by chance is printed first;\n"
        "with --dry-run nothing else. Choose a higher threshold for a large database.",
    .example = "surfacectl --db faces.db dedup --threshold 25"};
