/* report_csv.h -- an evaluation as tables (RFC 4180), for other programs. */
#ifndef CTL_REPORT_CSV_H
#define CTL_REPORT_CSV_H
#include <stddef.h>
#include <stdio.h>
#include "errinfo.h"

struct report; /* report.h */

/* Writers (ctl_dir.h); r is a struct report.  An empty field is a number that is not known.
 * Return ST_OK, ST_ENOMEM.
 * scores  every comparison, in the order of t->trial; behind them a row for each scan that
 *         was refused, with the code (dry_run_code()) and the reason
 * matrix  the scores, a row for each template and a column for each probe; empty where nothing
 *         was compared or a scan was refused
 * rates   false match rate and false non-match rate by threshold, of the comparisons made */
enum status report_csv_scores(FILE *to, const void *r, struct errinfo *e);
enum status report_csv_matrix(FILE *to, const void *r, struct errinfo *e);
enum status report_csv_rates(FILE *to, const void *r, struct errinfo *e);

/* A row for each of several evaluations; sets is a struct report_csv_list. */
struct report_csv_list {
    const struct report *report;
    size_t n;
};
enum status report_csv_sets(FILE *to, const void *sets, struct errinfo *e);

#endif
