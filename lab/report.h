/* report.h -- what an evaluation found, in the terms of ISO/IEC 19795-1, and its forms. */
#ifndef LAB_REPORT_H
#define LAB_REPORT_H
#include <stdint.h>
#include "newfile.h"
#include "rates.h"
#include "trials.h"

struct json;          /* json.h */
struct surface_model; /* model.h */

/* The share of n that went wrong; NaN when n is 0. */
struct report_rate {
    double value, low, high; /* 95 %, by a bootstrap over subjects */
    size_t n;
};

/* How many comparisons of one sort were decided how. */
struct report_count {
    size_t planned; /* those besides that a refused scan made impossible */
    size_t n, match, no_match, inconclusive;
};

/* Of which mated comparisons a rate is.  The non-mated ones are always those scored: a refusal
 * must not pay for a threshold that is easier to reach. */
enum report_of {
    REPORT_SCORED, /* those that were made */
    REPORT_ALL, /* all that were planned: what a refused scan made impossible is an error */
    REPORT_OF
};

#define REPORT_SEED UINT64_C(1) /* of the bootstrap */

struct report_curve {
    size_t n; /* mated comparisons */
    struct rates *rates;
    struct rates_figures f, low, high; /* at the report's threshold */
};

/* Another method's scores of the same comparisons (methods.h).  A mated comparison without a score is an
 * error. */
struct report_method {
    char *name;
    double *score; /* [t->n] score of each trial, higher: more alike; NaN: none */
    size_t scored; /* comparisons with a score */
    size_t mated, non_mated; /* mated and non-mated ones with a score */
    struct report_curve curve;
};

/* The probes of one kind, or all. */
struct report_group {
    const char *name;
    uint32_t kind;          /* index of corpus.kind; CORPUS_NONE: all */
    struct report_rate fta; /* failures to acquire, of the probes */
    uint32_t ranked, first; /* probes compared with others too; own template nearest */
    struct report_count mated;
    struct report_rate fnmr;      /* mated comparisons that are a non-match */
    struct report_rate unmatched; /* those that are no match: inconclusive ones too */
    struct report_rate
        frr; /* unmatched and refused ones of those planned: the generalised
                               false reject rate */
    struct report_curve
        curve[REPORT_OF]; /* this kind's mated scores, everybody's others */
};

/* Each probe as a search among the others' templates that it was compared with: without a template of its own, and
 * with it.  The threshold is that of their number (surface_search_threshold()). */
struct report_search {
    uint32_t people;  /* the most that a probe was compared with, its own included */
    double threshold; /* among so many; INFINITY: nobody matches */
    struct report_rate fpir; /* searches without the own template that match somebody */
    struct report_rate
        fnir; /* searches with it that do not find it, refusals included: 1 - TPIR */
};

struct report {
    const struct trials *t;
    const char *source, *made; /* folder, manifest or list; when */
    const char *calibration;   /* origin of the threshold */
    const char *engine;        /* surface_engine() */
    const struct surface_model *model;
    const char *enroll_kind;    /* kind of the option --enroll-kind, or NULL */
    struct report_group *group; /* the first is all */
    uint32_t ngroup;
    uint32_t untemplated;   /* subjects without a scan of the kind that is enrolled */
    struct report_rate fte; /* failures to enroll, of the templates */
    struct report_count non_mated, relative;
    struct report_rate fmr; /* non-mated comparisons that are a match */
    struct report_rate
        far; /* share of the planned ones: the generalised false accept rate */
    struct report_search search;
    double score_ms;              /* median of a comparison */
    struct report_method *method; /* [nmethod]; the caller's */
    size_t nmethod;
};

/* report_measure(r, t): fills r, which has source, made, calibration, engine, model and
 * enroll_kind, from the comparisons t, which r borrows.  Released by report_free(), also on
 * failure.  Cost: a bootstrap of all non-mated comparisons for each kind, twice.
 * Returns ST_OK, ST_ENOMEM. */
enum status report_measure(struct report *r, const struct trials *t);
void report_free(struct report *r);

/* report_measure_method(m, t): Fills counts and curve of m from its scores of the comparisons t; m->curve is
 * released by rates_free().  Returns ST_OK, ST_ENOMEM. */
enum status report_measure_method(struct report_method *m, const struct trials *t);

/* report_bound(rate, n): n independent comparisons of which this share, fewer than 3, went
 * wrong: what the true rate is below with 95 % confidence; 3 / n without any. */
double report_bound(double rate, size_t n);

/* ---- its forms: writers (newfile.h) of a struct report, and of lists of them.  An empty field
 * is a number that is not known.  Return ST_OK, ST_ENOMEM, ST_EIO.
 * report_csv_scores  every comparison, in the order of t->trial; behind them a row for each scan
 *                    that was refused, with the code (status_refusal()) and the reason
 * report_csv_matrix  the scores, a row for each template and a column for each probe; empty if
 *                    nothing was compared or a scan was refused
 * report_csv_rates   FMR and FNMR by threshold, of the comparisons made
 * report_csv_det     the FNMR, with intervals, and that of each kind, by FMR, of the comparisons made
 * report_csv_methods the FNMR of the program and of each method by FMR, with refusals
 * report_csv_sets    a row for each report of a struct report_list
 * report_json        the report as report.json has it */
struct report_list {
    const struct report *report;
    size_t n;
};
newfile_writer report_csv_scores, report_csv_matrix, report_csv_rates, report_csv_det,
    report_csv_methods, report_csv_sets;
newfile_writer report_json;

/* report_json_out(o, r): Writes the members of report.json into the object that is open in o. */
void report_json_out(struct json *o, const struct report *r);

#endif
