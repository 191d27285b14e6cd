/* The command dedup: the same face under two subjects. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store.h"
#include "ctl_command.h"
#include "ctl_cross.h"
#include "ctl_model.h"
#include "ctl_search.h"

static const char *only;                      /* --subject */
static double chosen_threshold = (double)NAN; /* --threshold */

/* Two subjects, by the templates with the highest score. */
struct ctl_dedup_pair {
    uint32_t x, y; /* two subjects, in their order */
    uint32_t a, b; /* a template of each */
    double score;
};

struct dedup {
    struct ctl *c;
    struct ctl_cross all;
    struct ctl_search search;
    uint32_t alone; /* the subject that is compared with all others; or CTL_SEARCH_ALL */

    struct store_calibration calibration; /* the calibration in force */
    double threshold;
    double pairs;                 /* pairs of templates of two subjects */
    struct ctl_dedup_pair *found; /* [nfound] */
    size_t nfound;
};

/* ---- templates that are compared */

static enum status list_all(struct dedup *d)
{
    enum status st = ctl_cross_list(d->c, &d->all);

    d->alone = CTL_SEARCH_ALL;
    for (uint32_t i = 0; only != NULL && i < d->all.nsubject; i++)
        if (strcmp(d->all.subject[i].id, only) == 0)
            d->alone = i;
    if (st == ST_OK && only != NULL && d->alone == CTL_SEARCH_ALL)
        st =
            errinfo_set(&d->c->e, ST_ENOTFOUND, "no subject %.128s has a template", only);
    return st;
}

static void count_pairs(struct dedup *d)
{
    const struct ctl_cross *p = &d->all;

    for (uint32_t i = 0; i < p->nsubject; i++) {
        const struct ctl_cross_subject *one = &p->subject[i];

        if (d->alone == CTL_SEARCH_ALL)
            d->pairs += (double)one->n * (p->ntemplate - one->first - one->n);
        else if (i == d->alone)
            d->pairs = (double)one->n * (p->ntemplate - one->n);
    }
}

/* That of an identification of each among all, so that about one in a hundred resembles somebody by chance.
 * Among more people than the calibration supports its highest: the list is read by a person. */
static double usual_threshold(const struct dedup *d)
{
    const struct surface_calibration *by = &d->calibration.table;
    const uint32_t most = surface_search_people(by);
    const uint32_t n = d->all.nsubject < most ? d->all.nsubject : most;

    return n > 1 ? surface_search_threshold(by, n) : by->threshold;
}

/* ---- output */

static void tell_costs(const struct dedup *d)
{
    int extrapolated;
    const double chance = d->pairs * surface_search_fpir(&d->calibration.table, 1,
                                                         d->threshold, &extrapolated);

    json_text(d->c->out, "engine", d->c->engine);
    json_number(d->c->out, "subjects", d->all.nsubject);
    json_number(d->c->out, "templates", d->all.ntemplate);
    json_number(d->c->out, "pairs", d->pairs);
    json_score(d->c->out, "threshold", d->threshold);
    json_rate(d->c->out, "by_chance", chance);
    json_flag(d->c->out, "extrapolated", extrapolated != 0);
    json_text(d->c->out, "calibration", d->calibration.shipped ? "shipped" : "database");
    (void)fprintf(stderr,
                  "surfacectl: %.0f pairs of templates of %" PRIu64
                  " subject%s; by chance about %.*f of them at or above %.2f, by %sthe "
                  "calibration of %s\n",
                  d->pairs, CTL_COUNT(d->all.nsubject), chance < 10 ? 2 : 0, chance,
                  d->threshold, extrapolated ? "extrapolating " : "",
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
    json_number(d->c->out, "compared", (double)d->search.compared);
    json_number(d->c->out, "inconclusive", (double)d->search.inconclusive);
    json_number(d->c->out, "skipped", d->search.skipped);
    json_number(d->c->out, "damaged", d->all.damaged);
    ctl_say(d->c, "%zu pair%s of subjects, by %" PRIu64 " comparison%s", d->nfound,
            d->nfound == 1 ? "" : "s", CTL_COUNT(d->search.compared));
    if (d->search.inconclusive > 0)
        ctl_say(d->c, ", of which %" PRIu64 " were inconclusive", d->search.inconclusive);
    ctl_say(d->c, "\n");
    if (d->search.skipped > 0)
        ctl_say(d->c,
                "%" PRIu64 " template%s skipped: damaged, deleted meanwhile, or made by "
                "another engine (template reencode)\n",
                CTL_COUNT(d->search.skipped));
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

/* The highest score of each two subjects, the highest of all first: the list does not depend on the order of the
 * pairs. */
static enum status keep_subjects(struct dedup *d)
{
    const size_t n = d->search.n;
    size_t kept = 0;

    if ((d->found = malloc((n + 1) * sizeof *d->found)) == NULL)
        return errinfo_memory(&d->c->e);
    for (size_t i = 0; i < n; i++) {
        const struct ctl_search_pair *p = &d->search.pair[i];

        d->found[i] = (struct ctl_dedup_pair){
            d->all.tmpl[p->a].owner, d->all.tmpl[p->b].owner, p->a, p->b, p->score};
    }
    if (n > 0)
        qsort(d->found, n, sizeof *d->found, by_subjects);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || d->found[kept - 1].x != d->found[i].x ||
            d->found[kept - 1].y != d->found[i].y)
            d->found[kept++] = d->found[i];
    if (kept > 0)
        qsort(d->found, kept, sizeof *d->found, by_score);
    d->nfound = kept;
    return ST_OK;
}

/* ---- the command */

static enum status dedup(struct dedup *d)
{
    struct ctl *c = d->c;
    enum status st;

    if ((st = store_calibration_current(d->c->store, &d->calibration, &c->e)) != ST_OK ||
        (st = list_all(d)) != ST_OK)
        return st;
    d->threshold = isnan(chosen_threshold) ? usual_threshold(d) : chosen_threshold;
    count_pairs(d);
    tell_costs(d);
    if (c->dry_run)
        return ST_OK;
    if ((st = ctl_search_run(c, &d->all, d->alone, d->threshold, &d->search)) != ST_OK ||
        (st = keep_subjects(d)) != ST_OK)
        return st;
    tell_found(d);
    if (d->all.damaged > 0)
        st = errinfo_set(&c->e, ST_ECORRUPT,
                         "%" PRIu64 " template%s damaged and not compared: run "
                         "surfacectl check-database",
                         (uint64_t)d->all.damaged, d->all.damaged == 1 ? " is" : "s are");
    return st;
}

static enum status ctl_dedup_run(struct ctl *c)
{
    struct dedup d = {.c = c};
    enum status st = ctl_model_open(c, STORE_READ);

    if (st == ST_OK)
        st = dedup(&d);
    c->code = d.nfound > 0 ? EXIT_NO : EXIT_FINE;
    ctl_cross_free(&d.all);
    ctl_search_free(&d.search);
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
                           "use this threshold instead of an identification's among so "
                           "many")},
    .exits = {"no duplicates", "duplicates were found"},
    .run = ctl_dedup_run,
    .summary = "find one face enrolled under two subjects",
    .help =
        "Lists pairs of subjects at or above the threshold, highest score first: they may be one\n"
        "person, relatives, or similar by chance. The expected number by chance is printed first;\n"
        "with --dry-run nothing else. The threshold rises with the number of subjects: a lower one\n"
        "finds more pairs of one person, and more by chance.",
    .example = "surfacectl --db faces.db dedup --threshold 15"};
