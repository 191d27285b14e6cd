/* report_csv.h -- every comparison of an evaluation, and its rates by threshold. */
#ifndef CTL_REPORT_CSV_H
#define CTL_REPORT_CSV_H
#include <stdio.h>
#include "errinfo.h"

/* Writers of scores.csv and rates.csv (ctl_dir.h); r is a struct report.  Return ST_OK. */
enum status report_csv_scores(FILE *to, const void *r, struct errinfo *e);
enum status report_csv_rates(FILE *to, const void *r, struct errinfo *e);

#endif
