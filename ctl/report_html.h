/* report_html.h -- the report of an evaluation as one page: the Markdown of report_text.h
 * in HTML, with the pictures in it. */
#ifndef CTL_REPORT_HTML_H
#define CTL_REPORT_HTML_H
#include <stdio.h>
#include "errinfo.h"

struct report; /* report.h */

struct report_html {
    const struct report *r;
    int dir; /* an open directory, where the pictures are by now */
};

/* A writer of report.html (ctl_dir.h); p is a struct report_html.
 * Returns ST_OK; ST_ENOMEM, ST_EIO (a picture cannot be read) with e filled. */
enum status report_html(FILE *to, const void *p, struct errinfo *e);

#endif
