/* surfacelab evaluate: error rates on collections of scans. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "corpus_pairs.h"
#include "corpus_read.h"
#include "lab.h"
#include "methods.h"
#include "model.h"
#include "outfile.h"
#include "report.h"
#include "utc.h"

/* A collection, and the folder that its report is written into. */
struct set {
    const char *source;
    char dir[PATH_MAX];
    struct corpus *corpus;
    struct trials *trials;
};

struct run {
    struct lab *c;
    struct set *set;
    struct report *report; /* [n], as are they */
    size_t n;
    const char *calibration; /* whose decides */
    char made[UTC_TEXT];
};

/* ---- the files */

static const struct {
    const char *file;
    newfile_writer *write;
} output[] = {{"scores.csv", report_csv_scores},  {"rates.csv", report_csv_rates},
              {"det.csv", report_csv_det},        {"report.json", report_json},
              {"matrix.csv", report_csv_matrix}, /* the last two, if they are wanted */
              {"methods.csv", report_csv_methods}};
#define OUTPUTS (sizeof output / sizeof *output)
#define MATRIX  (OUTPUTS - 2)
#define METHODS (OUTPUTS - 1)
#define TABLE   "sets.csv" /* of several */

#define PATH_SIZE (PATH_MAX + 16) /* a file in a folder */

/* Of several sets each has a folder in --out, by the set's own name, made different. */
static void name_folder(const struct run *r, size_t i, const char *out)
{
    struct set *const s = &r->set[i];
    const char *base = s->source;
    size_t end = strlen(base), begin, len;
    bool taken = r->n > 1;

    while (end > 0 && base[end - 1] == '/')
        end--;
    for (begin = end; begin > 0 && base[begin - 1] != '/'; begin--)
        ;
    base += begin;
    len = end - begin;
    if (strspn(base, ".") >= len) { /* "", ".", ".." */
        base = "set";
        len = strlen(base);
    }
    (void)snprintf(s->dir, sizeof s->dir, "%s", out);
    for (unsigned number = 1; taken; number++) {
        char suffix[12] = "";

        if (number > 1)
            (void)snprintf(suffix, sizeof suffix, "-%u", number);
        (void)snprintf(s->dir, sizeof s->dir, "%s/%.*s%s", out, (int)len, base, suffix);
        taken = false;
        for (size_t k = 0; k < i; k++)
            taken = taken || strcmp(r->set[k].dir, s->dir) == 0;
    }
}

static const char *path_of(const char *dir, const char *file, char out[PATH_SIZE])
{
    (void)snprintf(out, PATH_SIZE, "%s/%s", dir, file);
    return out;
}

/* Returns ST_OK if this file may be written: it is none of those that are read. */
static enum status may_write(struct run *r, const char *dir, const char *file)
{
    struct lab *c = r->c;
    char path[PATH_SIZE];
    enum status st = lab_may_write(c, path_of(dir, file, path));

    if (st == ST_OK)
        st = outfile_not_read(path, c->scores, &c->e);
    for (size_t i = 0; i < r->n && st == ST_OK; i++)
        st = lab_scan_not_read(c, r->set[i].corpus, r->set[i].source, path);
    return st;
}

static enum status may_write_all(struct run *r, const char *out)
{
    enum status st = r->n > 1 ? may_write(r, out, TABLE) : ST_OK;

    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < OUTPUTS && st == ST_OK; k++)
            st = may_write(r, r->set[i].dir, output[k].file);
    return st;
}

static enum status write_all(struct run *r, const char *out)
{
    const struct report_list list = {r->report, r->n};
    struct lab *c = r->c;
    char path[PATH_SIZE];
    enum status st = ST_OK;

    if (r->n > 1)
        st = lab_write(c, path_of(out, TABLE, path), report_csv_sets, &list);
    for (size_t i = 0; i < r->n; i++)
        for (size_t k = 0; k < OUTPUTS && st == ST_OK; k++) {
            const bool wanted = k == MATRIX    ? c->matrix
                                : k == METHODS ? c->scores != NULL
                                               : true;

            (void)path_of(r->set[i].dir, output[k].file, path);
            if (wanted)
                st = lab_write(c, path, output[k].write, &r->report[i]);
            else
                (void)unlink(path); /* none is left of a former run */
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

static void print_set(const struct report *r)
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
    (void)printf("search       among %u people, ", r->search.people);
    if (isfinite(r->search.threshold))
        (void)printf("threshold %.2f\n", r->search.threshold);
    else
        (void)printf("more than the calibration supports: nobody matches\n");
    print_share("FPIR", &r->search.fpir);
    print_share("FNIR", &r->search.fnir);
    for (size_t i = 0; i < r->nmethod; i++) {
        const struct report_method *m = &r->method[i];

        (void)printf(
            "\nmethod       %s: scores of %zu of %zu mated, %zu of %zu non-mated "
            "comparisons\n",
            m->name, m->mated, all->mated.planned, m->non_mated, r->non_mated.planned);
        print_curve(&m->curve);
    }
}

static void print_all(const struct run *r, const char *out)
{
    struct json *o = r->c->report;

    if (r->n > 1)
        json_array(o, "sets");
    for (size_t i = 0; i < r->n; i++) {
        if (r->n > 1)
            json_object(o, NULL);
        report_json_out(o, &r->report[i]);
        if (r->n > 1)
            json_close(o);
        corpus_left_print(r->set[i].corpus, "surfacelab");
        if (!r->c->json) {
            print_set(&r->report[i]);
            (void)printf("\n");
        }
    }
    if (r->n > 1)
        json_close(o);
    lab_say(r->c, "The report is in %s/\n", out);
}

/* ---- the command */

/* A scan where a collection should be?  Tables may end like one. */
static enum status check_usage(struct lab *c)
{
    static const char usage[] =
        "surfacelab evaluate DIR|MANIFEST..., or surfacelab evaluate "
        "--pairs LIST";

    if ((c->nargs == 0) != (c->pairs != NULL))
        return lab_usage(c, "usage: %s", usage);
    if (c->pairs != NULL && (c->non_mated > 0 || c->enroll_kind != NULL || c->burst > 0))
        return lab_usage(c,
                         "--pairs takes neither --non-mated, --enroll-kind nor --burst");
    if (c->burst > SURFACE_FRAMES_MAX)
        return lab_usage(c, "--burst takes at most %d frames", SURFACE_FRAMES_MAX);
    if (c->scores != NULL && c->nargs > 1)
        return lab_usage(c, "--scores takes one collection");
    for (int i = 0; i < c->nargs; i++)
        if (corpus_is_scan(c->args[i]))
            return lab_usage(c, "%.100s is one scan; usage: %s", c->args[i], usage);
    return ST_OK;
}

static enum status read_sets(struct run *r, const char *out)
{
    struct lab *c = r->c;
    enum status st = ST_OK;

    r->n = c->pairs != NULL ? 1 : (size_t)c->nargs;
    r->set = calloc(r->n, sizeof *r->set);
    r->report = calloc(r->n, sizeof *r->report);
    if (r->set == NULL || r->report == NULL) {
        r->n = 0;
        return errinfo_memory(&c->e);
    }
    for (size_t i = 0; i < r->n && st == ST_OK; i++) {
        struct set *s = &r->set[i];

        s->source = c->pairs != NULL ? c->pairs : c->args[i];
        st = c->pairs != NULL ? corpus_pairs_read(c->pairs, &s->corpus, &c->e)
                              : corpus_read(s->source, &s->corpus, &c->e);
        if (st == ST_OK && c->burst > 0)
            st = corpus_sessions(s->corpus, c->burst, &c->e);
        if (st == ST_OK && c->enroll_kind != NULL)
            st = corpus_enroll(s->corpus, c->enroll_kind, &c->e);
        name_folder(r, i, out);
    }
    return st;
}

static enum status evaluate(struct run *r, size_t i)
{
    struct lab *c = r->c;
    struct set *s = &r->set[i];
    enum status st = trials_run(c, s->corpus, &s->trials);

    if (st != ST_OK)
        return st;
    if (s->trials->n == 0)
        return errinfo_set(
            &c->e, ST_EINVAL,
            "%.100s: nothing to compare: no probe has a template of its own "
            "subject or another",
            s->source);
    r->report[i] = (struct report){.source = s->source,
                                   .made = r->made,
                                   .calibration = r->calibration,
                                   .engine = c->engine,
                                   .model = c->model,
                                   .enroll_kind = c->enroll_kind};
    if ((st = report_measure(&r->report[i], s->trials)) != ST_OK)
        return errinfo_set(&c->e, st, "the rates: %s", status_message(st));
    return c->scores == NULL ? ST_OK
                             : methods_read(c->scores, s->trials, &r->report[i].method,
                                            &r->report[i].nmethod, &c->e);
}

static enum status evaluate_all(struct run *r)
{
    const char *out = r->c->out != NULL ? r->c->out : "evaluation";
    int64_t now;
    enum status st = read_sets(r, out);

    (void)utc_now(&now);
    utc_print(now, r->made);
    if (st == ST_OK)
        st = may_write_all(r, out);
    for (size_t i = 0; i < r->n && st == ST_OK; i++)
        st = evaluate(r, i);
    if (st == ST_OK && (st = write_all(r, out)) == ST_OK)
        print_all(r, out);
    for (size_t i = 0; i < r->n; i++) {
        methods_free(r->report[i].method, r->report[i].nmethod);
        report_free(&r->report[i]);
        trials_free(r->set[i].trials);
        corpus_free(r->set[i].corpus);
    }
    free(r->report);
    free(r->set);
    return st;
}

enum status lab_evaluate(struct lab *c)
{
    struct run r = {.c = c,
                    .calibration =
                        isnan(c->threshold) ? "of the model" : "replaced by --threshold"};
    const enum status st = check_usage(c);

    if (st == ST_OK && c->out != NULL && strcmp(c->out, "-") == 0)
        return lab_usage(
            c, "evaluate writes several files: --out takes a folder (./- is one)");
    return st == ST_OK ? evaluate_all(&r) : st;
}
