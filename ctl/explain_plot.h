/* explain_plot.h -- explain.png. */
#ifndef CTL_EXPLAIN_PLOT_H
#define CTL_EXPLAIN_PLOT_H
#include <stdio.h>
#include "errinfo.h"

/* explain_plot(to, x, e): draws by gnuplot the three fields side by side, below them how
 * the gap and the rest are spread and the score of each region.  A file's writer
 * (ctl_dir.h); x is a struct explanation.
 * Returns as plot_run(); ST_ENOTFOUND: gnuplot is not installed.  ST_ENOMEM. */
enum status explain_plot(FILE *to, const void *x, struct errinfo *e);

#endif
