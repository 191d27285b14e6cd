/* report_text.h -- the report of an evaluation to be read, in Markdown. */
#ifndef CTL_REPORT_TEXT_H
#define CTL_REPORT_TEXT_H
#include <stddef.h>
#include <stdio.h>
#include "errinfo.h"

struct report; /* report.h */

/* A writer of report.md (ctl_dir.h); r is a struct report.  Returns ST_OK. */
enum status report_text(FILE *to, const void *r, struct errinfo *e);

/* report_text_sets(to, r, n): a table with a row for each of several reports. */
void report_text_sets(FILE *to, const struct report *r, size_t n);

#endif
