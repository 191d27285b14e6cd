/* surfacectl evaluate: error rates on collections of scans. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "cloudformat.h"
#include "corpus_pairs.h"
#include "corpus_read.h"
#include "in_force.h"
#include "model.h"
#include "ctl_command.h"
#include "ctl_corpus.h"
#include "ctl_dir.h"
#include "ctl_model.h"
#include "report.h"
#include "report_csv.h"
#include "report_json.h"
#include "report_text.h"

static const char *pairs, *enroll_kind;
static uint32_t non_mated;
static bool minimal, regions, matrix;

/* A collection, and the folder that its report is written into. */
struct set {
    const char *source;
    char *dir;
    struct corpus *corpus;
    struct ctl_trials *trials;
};

struct run {
    struct ctl *c;
    struct set *set;
    struct report *report; /* [n], as are they */
    size_t n;
    struct ctl_trials_how how;
    const char *calibration; /* whose decides */
    char made[32];
};

/* ---- the files */

static const struct {
    const char *file;
    newfile_writer *write;
} output[] = {{"scores.csv", report_csv_scores},
              {"rates.csv", report_csv_rates},
              {"report.json", report_json},
              {"report.md", report_text},
              {"matrix.csv", report_csv_matrix}}; /* the last one, if it is wanted */
#define OUTPUTS (sizeof output / sizeof *output)
#define MATRIX  (OUTPUTS - 1)
#define TABLE   "sets.csv" /* of several */

static char *join(const char *dir, const char *file, unsigned number)
{
    const size_t size = strlen(dir) + strlen(file) + 16;
    char *path = malloc(size), suffix[12] = "";

    if (number > 1)
        (void)snprintf(suffix, sizeof suffix, "-%u", number);
    if (path != NULL)
        (void)snprintf(path, size, "%s/%s%s", dir, file, suffix);
    return path;
}

/* Of several sets each has a folder in --out, by the set's own name, made different. */
static char *folder_of(const struct run *r, size_t i, const char *out)
{
    const char *source = r->set[i].source;
    size_t end = strlen(source), begin;
    char *base, *dir = NULL;
    bool taken = true;

    if (r->n == 1)
        return strdup(out);
    while (end > 0 && source[end - 1] == '/')
        end--;
    for (begin = end; begin > 0 && source[begin - 1] != '/'; begin--)
        ;
    base = strndup(source + begin, end - begin);
    if (base != NULL && base[strspn(base, ".")] == '\0') { /* "", ".", ".." */
        free(base);
        base = strdup("set");
    }
    for (unsigned number = 1; base != NULL && taken; number++) {
        free(dir);
        if ((dir = join(out, base, number)) == NULL)
            break;
        taken = false;
        for (size_t k = 0; k < i; k++)
            taken = taken || strcmp(r->set[k].dir, dir) == 0;
    }
    free(base);
    return dir;
}

/* May this file be written?  It is none of those that are read. */
static enum status may_write(struct run *r, const char *dir, const char *file)
{
    struct ctl *c = r->c;
    char *path = join(dir, file, 1);
    enum status st;

    if (path == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    st = ctl_dir_may_write(c, path, c->nargs);
    for (size_t i = 0; i < r->n && st == ST_OK; i++)
        st = ctl_corpus_not_read(c, r->set[i].corpus, r->set[i].source, path);
    free(path);
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

static enum status write_set(const struct report *r, const char *path, bool replace,
                             struct errinfo *e)
{
    int dir;
    enum status st = ctl_dir_open(path, &dir, e);

    for (size_t i = 0; i < OUTPUTS && st == ST_OK; i++)
        st = i == MATRIX && !matrix /* and none of a former run stays */
                 ? ctl_dir_remove(dir, output[i].file, e)
                 : ctl_dir_write(dir, output[i].file, replace, output[i].write, r, e);
    if (dir >= 0)
        (void)close(dir);
    return st;
}

static enum status write_all(struct run *r, const char *out)
{
    const struct report_csv_list list = {r->report, r->n};
    struct errinfo *e = &r->c->e;
    int dir;
    enum status st = ctl_dir_open(out, &dir, e);

    for (size_t i = 0; i < r->n && st == ST_OK; i++)
        st = write_set(&r->report[i], r->set[i].dir, r->c->force, e);
    if (st == ST_OK && r->n > 1)
        st = ctl_dir_write(dir, TABLE, r->c->force, report_csv_sets, &list, e);
    if (dir >= 0)
        (void)close(dir);
    return st;
}

static void print_all(const struct run *r, const char *out)
{
    struct json *o = r->c->out;

    if (r->n > 1)
        json_array(o, "sets");
    for (size_t i = 0; i < r->n; i++) {
        if (r->n > 1)
            json_object(o, NULL);
        report_json_out(o, &r->report[i]);
        if (r->n > 1)
            json_close(o);
        ctl_corpus_tell(r->set[i].corpus);
    }
    if (r->n > 1)
        json_close(o);
    if (r->c->json)
        return;
    if (r->n > 1)
        report_text_sets(stdout, r->report, r->n);
    else
        (void)report_text(stdout, r->report, NULL);
    (void)printf("\nThe report is in %s/\n", out);
}

/* ---- the command */

/* A scan where a collection should be?  Tables may end like one. */
static bool is_scan(const char *path)
{
    const char *ending = cloudformat_ending(path);
    struct stat info;

    return ending != NULL && strcasecmp(ending, ".csv") != 0 &&
           strcasecmp(ending, ".txt") != 0 && stat(path, &info) == 0 &&
           S_ISREG(info.st_mode);
}

static enum status check_usage(struct ctl *c)
{
    static const char usage[] =
        "surfacectl evaluate DIR|MANIFEST..., or surfacectl evaluate "
        "--pairs LIST";

    if ((c->nargs == 0) != (pairs != NULL))
        return ctl_usage(c, "usage: %s", usage);
    if (pairs != NULL && (non_mated > 0 || enroll_kind != NULL))
        return ctl_usage(c, "--pairs is compared as listed: without --non-mated and "
                            "--enroll-kind");
    for (int i = 0; i < c->nargs; i++)
        if (is_scan(c->args[i]))
            return ctl_usage(c, "%.100s is one scan; usage: %s", c->args[i], usage);
    return ST_OK;
}

static enum status read_sets(struct run *r, const char *out)
{
    struct ctl *c = r->c;
    enum status st = ST_OK;

    r->n = pairs != NULL ? 1 : (size_t)c->nargs;
    r->set = calloc(r->n, sizeof *r->set);
    r->report = calloc(r->n, sizeof *r->report);
    if (r->set == NULL || r->report == NULL) {
        r->n = 0;
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    }
    for (size_t i = 0; i < r->n && st == ST_OK; i++) {
        struct set *s = &r->set[i];

        s->source = pairs != NULL ? pairs : c->args[i];
        st = pairs != NULL ? corpus_pairs_read(pairs, &s->corpus, &c->e)
                           : corpus_read(s->source, &s->corpus, &c->e);
        if (st == ST_OK && enroll_kind != NULL)
            st = corpus_enroll(s->corpus, enroll_kind, &c->e);
        if (st == ST_OK && (s->dir = folder_of(r, i, out)) == NULL)
            st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    }
    return st;
}

static enum status evaluate(struct run *r, size_t i)
{
    struct ctl *c = r->c;
    struct set *s = &r->set[i];
    enum status st = ctl_trials_run(c, s->corpus, &r->how, &s->trials);

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
                                   .enroll_kind = enroll_kind};
    if ((st = report_measure(&r->report[i], s->trials)) != ST_OK)
        (void)errinfo_set(&c->e, st, "the rates: %s", status_message(st));
    return st;
}

static enum status evaluate_all(struct run *r)
{
    const char *out;
    const time_t now = time(NULL);
    struct tm utc;
    enum status st = ctl_dir_folder(r->c, "evaluation", &out);

    if (st == ST_OK)
        st = read_sets(r, out);
    if (gmtime_r(&now, &utc) != NULL)
        (void)strftime(r->made, sizeof r->made, "%Y-%m-%dT%H:%M:%SZ", &utc);
    if (st == ST_OK)
        st = may_write_all(r, out);
    for (size_t i = 0; i < r->n && st == ST_OK; i++)
        st = evaluate(r, i);
    if (st == ST_OK && (st = write_all(r, out)) == ST_OK)
        print_all(r, out);
    for (size_t i = 0; i < r->n; i++) {
        report_free(&r->report[i]);
        ctl_trials_free(r->set[i].trials);
        corpus_free(r->set[i].corpus);
        free(r->set[i].dir);
    }
    free(r->report);
    free(r->set);
    return st;
}

static enum status run(struct ctl *c)
{
    struct run r = {.c = c, .calibration = "as shipped"};
    struct store_calibration k;
    enum status st = check_usage(c);

    if (st == ST_OK && c->db != NULL && (st = ctl_model_open(c, STORE_READ)) == ST_OK &&
        (st = in_force_get(c->store, &k, &c->e)) == ST_OK) {
        r.how.calibration = &k.table;
        r.calibration = k.shipped ? r.calibration : "of the database";
    }
    if (st != ST_OK)
        return st;
    if (!isnan(c->threshold))
        r.calibration = "replaced by --threshold";
    r.how.non_mated = non_mated > 0 ? non_mated : matrix ? CTL_TRIALS_ALL : 0;
    r.how.minimal = minimal;
    r.how.regions = regions;
    r.how.regions = regions;
    return evaluate_all(&r);
}

const struct ctl_command ctl_evaluate = {
    .name = "evaluate",
    .args = "DIR|MANIFEST...",
    .takes = {0, CTL_MANY},
    .database = CTL_TAKES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_THRESHOLD | CTL_OUT | CTL_THREADS | CTL_FORCE,
    .options =
        {CTL_OPTION("non-mated", "N", ctl_option_whole, &non_mated,
                    "compare each probe with N other subjects (all, up to 200,000\n"
                    "comparisons)"),
         CTL_OPTION("enroll-kind", "KIND", ctl_option_text, &enroll_kind,
                    "enroll each subject's first scan of this kind (enroll, or else\n"
                    "the first scan)"),
         CTL_OPTION("pairs", "FILE", ctl_option_text, &pairs,
                    "instead of DIR: compare the pairs in this list, a template and\n"
                    "a probe a line, and perhaps a label (mated or non-mated)"),
         CTL_OPTION("minimal", NULL, ctl_option_flag, &minimal,
                    "measure the minimal disparity of each comparison too"),
         CTL_OPTION("regions", NULL, ctl_option_flag, &regions,
                    "give each region's part of each score too"),
         CTL_OPTION("matrix", NULL, ctl_option_flag, &matrix,
                    "compare every template with every probe, and write the scores\n"
                    "as a matrix")},
    .run = run,
    .summary = "measure error rates on collections of scans",
    .help =
        "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table, with\n"
        "the columns file and subject.  Of each subject one scan is enrolled in memory and\n"
        "compared with the subject's other scans and with other subjects'.  These files are\n"
        "written into the folder --out (./evaluation): report.md, report.json, scores.csv (every\n"
        "comparison and every refusal), rates.csv and, if wanted, matrix.csv; of several\n"
        "collections into a folder of each, and sets.csv with a row for each.  With a database\n"
        "its calibration decides.  surfacectl(1) says more.",
    .example = "surfacectl evaluate scans --out evaluation"};
