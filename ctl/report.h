/* report.h -- what an evaluation found, in the terms of ISO/IEC 19795-1.  Its forms are
 * report_text.h, report_html.h, report_json.h, report_csv.h and report_plot.h. */
#ifndef CTL_REPORT_H
#define CTL_REPORT_H
#include <stdint.h>
#include "ctl_trials.h"
#include "rates.h"

/* The share of n comparisons that went wrong; NaN when n is 0. */
struct report_rate {
    double value, low, high; /* 95 %, by a bootstrap over subjects */
    size_t n;
};

/* How many comparisons of one sort were decided how. */
struct report_count {
    size_t n, match, no_match, inconclusive;
};

/* The probes of one kind, or all. */
struct report_group {
    const char *name;
    uint32_t kind;          /* of the corpus, or CORPUS_NONE: all */
    uint32_t probe;         /* how many */
    uint32_t refused;       /* of which no model could be made: failures to acquire */
    uint32_t ranked, first; /* probes compared with others too; own template nearest */
    struct report_count mated;
    struct report_rate no_match;  /* mated comparisons decided so */
    struct report_rate unmatched; /* and the inconclusive ones besides */
    struct rates *rates; /* this kind's mated scores, everybody's non-mated scores */
    struct rates_figures f, low, high;
    size_t posed;  /* probes whose rotation error is known, and its quantiles */
    size_t beyond; /* more than 3 degrees */
    double median_deg, most_deg, worst_deg; /* 50, 90, 100 per cent */
};

struct report {
    const struct ctl_trials *t;
    const char *source, *made; /* folder or manifest; when */
    const char *calibration;   /* whose decided */
    const char *engine;        /* face_engine() */
    double threshold_mm;
    unsigned replicates; /* of the bootstrap */
    uint64_t seed;
    struct report_group *group; /* the first is all */
    uint32_t ngroup;
    uint32_t unenrolled; /* templates refused: failures to enrol */
    size_t undone;       /* comparisons planned that a refused scan made impossible */
    struct report_count non_mated, relative;
    struct report_rate match;    /* non-mated comparisons decided so */
    double align_ms, measure_ms; /* median of a comparison */
    char plots[480];             /* why there are none, or "" */
};

/* report_measure(r, t): fills r, which has source, made, calibration and engine, from the
 * comparisons t, which r borrows.  Released by report_free(), also on failure.
 * Returns ST_OK, ST_ENOMEM. */
enum status report_measure(struct report *r, const struct ctl_trials *t);
void report_free(struct report *r);

/* report_bound(rate, n): n independent comparisons of which this share, fewer than 3, went
 * wrong: what the true rate is below with 95 % confidence; 3 / n without any. */
double report_bound(double rate, size_t n);

/* report_step(r, most, n): the step of thresholds, a round number of mm, that leads from 0
 * to the largest score in *n <= most steps. */
double report_step(const struct report *r, size_t most, size_t *n);

#endif
