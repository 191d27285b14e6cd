/* surfacectl evaluate: error rates on a collection of scans. */
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "calibration.h"
#include "ctl_command.h"
#include "ctl_corpus.h"
#include "ctl_dir.h"
#include "ctl_model.h"
#include "report.h"
#include "report_csv.h"
#include "report_html.h"
#include "report_json.h"
#include "report_plot.h"
#include "report_text.h"

/* ---- the files */

typedef enum status writer(FILE *to, const void *arg, struct errinfo *e);

/* The pictures of this run, and none of a former one. */
static enum status write_pictures(struct report *r, int dir, struct errinfo *e)
{
    static const struct {
        const char *file, *format;
        writer *write;
    } picture[] = {{"det.svg", "svg", report_plot_det},
                   {"det.png", "pngcairo", report_plot_det},
                   {"scores.svg", "svg", report_plot_scores},
                   {"scores.png", "pngcairo", report_plot_scores}};
    struct errinfo why;
    enum status st = ST_OK;

    for (size_t i = 0; i < sizeof picture / sizeof *picture && st == ST_OK; i++) {
        const struct report_plot p = {r, picture[i].format};

        if (r->non_mated.n == 0)
            (void)snprintf(r->plots, sizeof r->plots,
                           "there are no non-mated comparisons");
        else if (r->plots[0] == '\0' &&
                 ctl_dir_write(dir, picture[i].file, picture[i].write, &p, &why) != ST_OK)
            (void)snprintf(r->plots, sizeof r->plots, "%s", why.msg);
    }
    for (size_t i = 0; i < sizeof picture / sizeof *picture && r->plots[0] != '\0'; i++)
        if (st == ST_OK)
            st = ctl_dir_remove(dir, picture[i].file, e);
    return st;
}

static enum status write_all(struct report *r, const char *path, struct errinfo *e)
{
    static const struct {
        const char *file;
        writer *write;
    } table[] = {{"scores.csv", report_csv_scores},
                 {"rates.csv", report_csv_rates},
                 {"report.json", report_json},
                 {"report.md", report_text}};
    int dir;
    enum status st = ctl_dir_open(path, &dir, e);

    if (st == ST_OK)
        st = write_pictures(r, dir, e); /* first: the report says whether there are any */
    for (size_t i = 0; i < sizeof table / sizeof *table && st == ST_OK; i++)
        st = ctl_dir_write(dir, table[i].file, table[i].write, r, e);
    if (st == ST_OK) {
        const struct report_html page = {r, dir};

        st = ctl_dir_write(dir, "report.html", report_html, &page, e);
    }
    if (dir >= 0)
        (void)close(dir);
    return st;
}

/* ---- the command */

static uint32_t non_mated; /* --non-mated */

static enum status evaluate(struct ctl *c, const struct corpus *corpus,
                            const struct decision *decision, const char *calibration)
{
    const time_t now = time(NULL);
    const char *dir = c->dir != NULL ? c->dir : "evaluation";
    struct report r = {
        .source = c->args[0], .calibration = calibration, .engine = c->engine};
    struct ctl_trials *t;
    struct tm utc;
    char made[32] = "";
    enum status st = ctl_trials_run(c, corpus, decision, non_mated, &t);

    if (st != ST_OK)
        return st;
    if (gmtime_r(&now, &utc) != NULL)
        (void)strftime(made, sizeof made, "%Y-%m-%dT%H:%M:%SZ", &utc);
    r.made = made;
    if ((st = report_measure(&r, t)) != ST_OK)
        (void)errinfo_set(&c->e, st, "the rates: %s", status_message(st));
    else if (t->n == r.undone)
        st = errinfo_set(
            &c->e, ST_EINVAL, "%.100s: nothing could be compared: %.100s", c->args[0],
            t->n == 0 ? "no subject has a second scan" : "scans were refused");
    else
        st = write_all(&r, dir, &c->e);
    if (st == ST_OK) {
        report_json_out(c->out, &r);
        ctl_corpus_tell(corpus);
        if (!c->json) {
            (void)report_text(stdout, &r, NULL);
            (void)printf("\nThe report is in %s/\n", dir);
        }
        if (r.plots[0] != '\0')
            (void)fprintf(stderr, "surfacectl: no pictures: %s\n", r.plots);
    }
    report_free(&r);
    ctl_trials_free(t);
    return st;
}

static enum status run(struct ctl *c)
{
    const struct decision *decision = NULL;
    struct store_calibration k;
    struct corpus *corpus = NULL;
    const char *calibration = "as shipped";
    enum status st = ST_OK;

    if (c->db != NULL && (st = ctl_model_open(c, STORE_READ)) == ST_OK &&
        (st = calibration_in_force(c->store, &k, &c->e)) == ST_OK) {
        decision = &k.decision;
        calibration = k.shipped ? calibration : "of the database";
    }
    if (st == ST_OK && (st = corpus_read(c->args[0], &corpus, &c->e)) == ST_OK)
        st = evaluate(c, corpus, decision, calibration);
    corpus_free(corpus);
    return st;
}

const struct ctl_command ctl_evaluate = {
    .name = "evaluate",
    .args = "DIR|MANIFEST",
    .takes = {1, 1},
    .database = CTL_TAKES_DATABASE,
    .shared = CTL_SCANS | CTL_MODEL | CTL_THRESHOLD | CTL_OUT | CTL_THREADS,
    .options = {CTL_OPTION(
        "non-mated", "N", ctl_option_whole, &non_mated,
        "compare each probe with N other subjects (all, up to 200,000\n"
        "comparisons)")},
    .run = run,
    .summary = "measure error rates on a collection of scans",
    .help =
        "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table, with\n"
        "the columns file and subject.  Of each subject the scan of kind `enroll`, or else the\n"
        "first, is enrolled in memory and compared with the subject's other scans and with other\n"
        "subjects'.  These files are written into the folder --out (./evaluation): report.html\n"
        "(with its pictures), report.md, report.json, scores.csv (every comparison), rates.csv,\n"
        "and by gnuplot det and scores as .svg and .png.  With a database its calibration\n"
        "decides.  surfacectl(1) says more.",
    .example = "surfacectl evaluate scans --out evaluation"};
