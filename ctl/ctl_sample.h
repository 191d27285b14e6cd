/* ctl_sample.h -- a scan's file as a face. */
#ifndef CTL_SAMPLE_H
#define CTL_SAMPLE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include "sample.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct ctl;         /* ctl.h */
struct errinfo;     /* errinfo.h */

/* ctl_sample_read(c, path, enrolment, w, out, found): the face in a file ("-": standard input), read as
 * c->scans says.  enrolment: by the strict gate.  Every failure is in c->e, with the path.
 * ctl_sample_parse(), ctl_sample_build(): the same in two steps, for callers that need the points
 * or what was found (sample.h); cloudpoints_free() (empty on failure). */
enum status ctl_sample_read(struct ctl *c, const char *path, bool enrolment,
                            struct surface_work *w, struct surface_face **out,
                            struct sample_found *found);
enum status ctl_sample_parse(struct ctl *c, const char *path, struct cloudpoints *out);
enum status ctl_sample_build(struct ctl *c, const char *path, struct cloudpoints *p,
                             bool enrolment, struct surface_work *w,
                             struct surface_face **out, struct sample_found *found);

/* ctl_sample_warnings(to, label, f): a line "warnings     occluded, turned", where "warnings" is
 * the label; nothing without any. */
void ctl_sample_warnings(FILE *to, const char *label, const struct sample_found *f);

#endif
