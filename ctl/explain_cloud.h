/* explain_cloud.h -- explain.ply. */
#ifndef CTL_EXPLAIN_CLOUD_H
#define CTL_EXPLAIN_CLOUD_H
#include <stdio.h>
#include "errinfo.h"

/* explain_cloud(to, x, e): writes the probe's points where they lie on the template, in the
 * colours of the rest, with the three fields as properties.  A file's writer (ctl_dir.h);
 * x is a struct explanation; a write error shows in `to`'s own state.  Returns ST_OK. */
enum status explain_cloud(FILE *to, const void *x, struct errinfo *e);

#endif
