/* report_plot.h -- the pictures of an evaluation, by gnuplot. */
#ifndef CTL_REPORT_PLOT_H
#define CTL_REPORT_PLOT_H
#include <stdio.h>
#include "errinfo.h"

struct report; /* report.h */

struct report_plot {
    const struct report *r;
    const char *format; /* of gnuplot's terminals "svg" or "pngcairo" */
};

/* Writers of pictures (ctl_dir.h); p is a struct report_plot.  Return as plot_run();
 * ST_ENOTFOUND: gnuplot is not installed.
 * det     FNMR over FMR.  Where no error was seen a rate cannot be drawn: there the curve is
 *         dashed, at the bound 3 / N by the rule of 3 (rates.h), and the area below the
 *         bounds is grey.
 * scores  histograms of the scores by the kind of comparison. */
enum status report_plot_det(FILE *to, const void *p, struct errinfo *e);
enum status report_plot_scores(FILE *to, const void *p, struct errinfo *e);

#endif
