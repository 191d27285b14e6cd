/* surfacelab evaluate: error rates on a collection of scans. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "corpus_pairs.h"
#include "corpus_read.h"
#include "lab.h"
#include "model.h"
#include "report.h"
#include "utc.h"

/* ---- the files */

static const struct {
    const char *name;
    newfile_writer *write;
} file[] = {{"scores.csv", report_csv_scores},
            {"rates.csv", report_csv_rates},
            {"report.json", report_json}};
#define FILES (sizeof file / sizeof *file)

/* Returns ST_OK if the files of the folder may be written: none of them is one that is read. */
static enum status may_write(struct lab *c, const char *folder, const char *source,
                             const struct corpus *k)
{
    char path[PATH_MAX];
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < FILES; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, file[i].name);
        if ((st = lab_may_write(c, path)) == ST_OK)
            st = lab_scan_not_read(c, k, source, path);
    }
    return st;
}

static enum status write_all(struct lab *c, const char *folder, const struct report *r)
{
    char path[PATH_MAX];
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < FILES; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, file[i].name);
        st = lab_write(c, path, file[i].write, r);
    }
    return st;
}

/* ---- the summary */

/* A share of n in per cent with its interval; if n does not support it, what it is below. */
static void print_rate(const char *name, double rate, double low, double high, size_t n)
{
    (void)printf("%-12s ", name);
    if (n == 0 || isnan(rate))
        (void)printf("no comparisons\n");
    else if (!rates_supported(rate, n))
        (void)printf("below %.3g %% (%.0f of %zu)\n",
                     100 * fmin(1, report_bound(rate, n)), round(rate * (double)n), n);
    else
        (void)printf("%.3g %% [%.3g to %.3g]\n", 100 * rate, 100 * low, 100 * high);
}

static void print_share(const char *name, const struct report_rate *x)
{
    print_rate(name, x->value, x->low, x->high, x->n);
}

/* What the comparisons do not support stands beside what was counted. */
static void print_curve(const struct report_curve *g)
{
    const size_t mated = g->n, non_mated = rates_nimpostor(g->rates);

    print_rate("EER", g->f.eer, g->low.eer, g->high.eer,
               mated < non_mated ? mated : non_mated);
    for (int k = 0; k < RATES_TARGETS; k++)
        if (rates_supported(rates_target[k], non_mated))
            (void)printf("TAR          %.4g %% at FMR %g %%, threshold %.2f\n",
                         100 * g->f.tar[k], 100 * rates_target[k], g->f.tar_score[k]);
        else
            (void)printf(
                "TAR          not supported at FMR %g %%: %zu non-mated "
                "comparisons are needed (counted: %.0f of %zu mated match, "
                "%.0f of %zu non-mated)\n",
                100 * rates_target[k], rates_needed(rates_target[k]),
                round(g->f.tar[k] * (double)mated), mated,
                round(rates_fmr(g->rates, g->f.tar_score[k]) * (double)non_mated),
                non_mated);
}

static void print_report(const struct report *r)
{
    const struct report_group *all = &r->group[0];

    (void)printf("scans        %s: %u subjects, %u scans\n", r->source,
                 r->t->corpus->nsubject, r->t->corpus->nscan);
    (void)printf("comparisons  %zu mated, %zu non-mated, %zu of close relatives\n",
                 all->mated.n, r->non_mated.n, r->relative.n);
    (void)printf("threshold    %.4g, calibration %s\n", r->t->threshold, r->calibration);
    print_share("FTE", &r->fte);
    print_share("FTA", &all->fta);
    print_curve(&all->curve[REPORT_SCORED]);
    print_share("FNMR", &all->fnmr);
    print_share("FMR", &r->fmr);
    print_share("FRR", &all->frr);
    print_share("FAR", &r->far);
}

/* ---- the command */

/* Refuses a scan in the place of a collection: tables may end like one. */
static enum status check_usage(struct lab *c)
{
    static const char usage[] =
        "surfacelab evaluate DIR|MANIFEST, or surfacelab evaluate --pairs LIST";

    if ((c->nargs == 0) != (c->pairs != NULL))
        return lab_usage(c, "usage: %s", usage);
    if (c->pairs != NULL && (c->non_mated > 0 || c->enroll_kind != NULL || c->burst > 0))
        return lab_usage(c,
                         "--pairs takes neither --non-mated, --enroll-kind nor --burst");
    if (c->burst > SURFACE_FRAMES_MAX)
        return lab_usage(c, "--burst takes at most %d frames", SURFACE_FRAMES_MAX);
    if (c->nargs > 0 && corpus_is_scan(c->args[0]))
        return lab_usage(c, "%.100s is one scan; usage: %s", c->args[0], usage);
    if (c->out != NULL && strcmp(c->out, "-") == 0)
        return lab_usage(
            c, "evaluate writes several files: --out takes a folder (./- is one)");
    return ST_OK;
}

static enum status read_corpus(struct lab *c, const char *source, struct corpus **out)
{
    enum status st = c->pairs != NULL ? corpus_pairs_read(source, out, &c->e)
                                      : corpus_read(source, out, &c->e);

    if (st == ST_OK && c->burst > 0)
        st = corpus_sessions(*out, c->burst, &c->e);
    if (st == ST_OK && c->enroll_kind != NULL)
        st = corpus_enroll(*out, c->enroll_kind, &c->e);
    return st;
}

static enum status measure(struct lab *c, const struct trials *t, struct report *r)
{
    enum status st;

    if (t->n == 0)
        return errinfo_set(
            &c->e, ST_EINVAL,
            "%.100s: nothing to compare: no probe has a template of its own "
            "subject or another",
            r->source);
    if ((st = report_measure(r, t)) != ST_OK)
        return errinfo_set(&c->e, st, "the rates: %s", status_message(st));
    return ST_OK;
}

enum status lab_evaluate(struct lab *c)
{
    const char *folder = c->out != NULL ? c->out : "evaluation";
    struct report r = {.source = c->pairs != NULL ? c->pairs : c->args[0],
                       .calibration = isnan(c->threshold) ? "of the model"
                                                          : "replaced by --threshold",
                       .engine = c->engine,
                       .model = c->model,
                       .enroll_kind = c->enroll_kind};
    struct corpus *corpus = NULL;
    struct trials *t = NULL;
    int64_t now;
    enum status st = check_usage(c);

    (void)utc_now(&now);
    utc_print(now, r.made);
    if (st == ST_OK && (st = read_corpus(c, r.source, &corpus)) == ST_OK &&
        (st = may_write(c, folder, r.source, corpus)) == ST_OK &&
        (st = trials_run(c, corpus, &t)) == ST_OK && (st = measure(c, t, &r)) == ST_OK &&
        (st = write_all(c, folder, &r)) == ST_OK) {
        report_json_out(c->report, &r);
        corpus_left_print(corpus, "surfacelab");
        if (!c->json)
            print_report(&r);
        lab_say(c, "\nThe report is in %s/\n", folder);
    }
    report_free(&r);
    trials_free(t);
    corpus_free(corpus);
    return st;
}
