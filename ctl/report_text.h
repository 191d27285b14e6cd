/* report_text.h -- the report of an evaluation to be read, in Markdown. */
#ifndef CTL_REPORT_TEXT_H
#define CTL_REPORT_TEXT_H
#include <stdio.h>
#include "errinfo.h"

struct report_rate; /* report.h */

/* A writer of report.md (ctl_dir.h); r is a struct report.  Used of Markdown, a line each:
 * # and ## headings, tables, lists by -, pictures, paragraphs; backslashes before what would
 * begin anything else.  Returns ST_OK. */
enum status report_text(FILE *to, const void *r, struct errinfo *e);

/* report_text_rate(x): "1.2 % [0.8-1.9]", or what can be said without enough comparisons:
 * "below 3 % (0 of 100)". */
struct report_text_cell {
    char s[120];
};
struct report_text_cell report_text_rate(const struct report_rate *x);

#endif
