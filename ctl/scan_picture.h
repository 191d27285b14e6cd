/* scan_picture.h -- a scan as a picture: what was delivered beside the face that was found. */
#ifndef CTL_SCAN_PICTURE_H
#define CTL_SCAN_PICTURE_H
#include <stdio.h>
#include "scan_canvas.h"

struct advice;  /* advice.h */
struct errinfo; /* errinfo.h */

struct scan_picture {
    struct scan_drawn drawn;
    const char *verdict; /* "Usable for enrolment" */
    const char *reason;  /* a line under it, or "" */
    double quality;      /* NAN: not known */
    const struct advice *advice;
};

/* scan_picture(to, p, e): a PNG of the struct scan_picture p, by gnuplot (plot.h).  The names
 * of files stay out of it.  A newfile_writer.  Returns as plot_run(); ST_ENOMEM. */
enum status scan_picture(FILE *to, const void *p, struct errinfo *e);

#endif
