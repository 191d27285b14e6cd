/* ctl_report.h -- what an evaluation found, and its report in the form that ISO/IEC
 * 19795-1 asks for: report.md, report.json, scores.csv, rates.csv, and by gnuplot det and
 * scores as .svg and .png. */
#ifndef DB_SURFACECTL_REPORT_H
#define DB_SURFACECTL_REPORT_H
#include <stdio.h>
#include "ctl_trials.h"

/* The share of n comparisons that went wrong; NaN when n is 0. */
struct ctl_report_rate {
    double value, low, high; /* 95 %, by a bootstrap over subjects */
    size_t n;
};

/* How many comparisons of one sort were decided how. */
struct ctl_report_count {
    size_t n, match, no_match, inconclusive;
};

/* The probes of one kind, or all. */
struct ctl_report_group {
    const char *name;
    uint32_t kind;          /* of the corpus, or CORPUS_NONE: all */
    uint32_t probe;         /* how many */
    uint32_t refused;       /* of which no model could be made: failures to acquire */
    uint32_t ranked, first; /* probes compared with others too; own template nearest */
    struct ctl_report_count genuine;
    struct ctl_report_rate no_match;  /* genuine ones decided so */
    struct ctl_report_rate unmatched; /* and the inconclusive ones besides */
    struct rates *rates; /* this kind's genuine scores, everybody's impostor scores */
    struct rates_figures f, low, high;
    size_t posed;  /* probes whose rotation error is known, and its quantiles */
    size_t beyond; /* more than 3 degrees */
    double median_deg, most_deg, worst_deg; /* 50, 90, 100 per cent */
};

struct ctl_report {
    const struct ctl_trials *t;
    const char *source, *made, *judge; /* folder or manifest; when; which calibration */
    const char *engine;                /* face_engine() */
    double threshold_mm;
    unsigned replicates; /* of the bootstrap */
    uint64_t seed;
    struct ctl_report_group *group; /* the first is all */
    uint32_t ngroup;
    uint32_t unenrolled; /* templates refused: failures to enroll */
    size_t undone;       /* comparisons planned that a refused scan made impossible */
    struct ctl_report_count impostor, relative;
    struct ctl_report_rate match; /* impostors decided so */
    double align_ms, measure_ms;  /* median of a comparison */
    char plots[280];              /* why there are none, or "" */
};

/* ctl_report_write(r, path, e): every file of the report into the folder path, which
 * is made when it is not there; files of the same names are replaced.  Without gnuplot
 * there are no pictures, and r->plots says why.
 * Returns ST_OK; ST_EIO, ST_EDENIED, ST_ENOMEM with e filled. */
enum status ctl_report_write(struct ctl_report *r, const char *path, struct errinfo *e);

/* The report to be read (Markdown), and the same as members of o's open object. */
void ctl_report_text(const struct ctl_report *r, FILE *to);
void ctl_report_json(const struct ctl_report *r, struct ctl_out *o);

/* Writers of files (ctl_dir.h); r is a struct ctl_report. */
enum status ctl_report_scores(FILE *to, const void *r, struct errinfo *e);
enum status ctl_report_rates(FILE *to, const void *r, struct errinfo *e);

/* A picture: by gnuplot, in a format that it calls so ("svg", "pngcairo"). */
struct ctl_report_picture {
    const struct ctl_report *r;
    const char *format;
};
/* Writers of pictures; p is a struct ctl_report_picture.  ST_ENOTFOUND: gnuplot is
 * not there. */
enum status ctl_report_det(FILE *to, const void *p, struct errinfo *e);
enum status ctl_report_histogram(FILE *to, const void *p, struct errinfo *e);

/* ctl_report_step(r, most, n): the step of thresholds, a round number of mm, that
 * leads from 0 to the largest score in *n <= most steps. */
double ctl_report_step(const struct ctl_report *r, size_t most, size_t *n);

#endif
