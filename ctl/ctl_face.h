/* ctl_face.h -- the face in a scan's file; comparisons as text. */
#ifndef CTL_FACE_H
#define CTL_FACE_H
#include <stdbool.h>
#include <stdio.h>
#include "libsurface.h"
#include "sample.h"
#include "store.h"
#include "templates.h"

struct cloudpoints; /* cloudpoints.h */
struct ctl;         /* ctl.h */

/* ctl_face_parse(c, path, out): Reads the points of a file ("-": standard input) as c->scans says.
 *   out     to be released by cloudpoints_free(); empty on failure
 * A failure is in c->e, with the path. */
enum status ctl_face_parse(struct ctl *c, const char *path, struct cloudpoints *out);

/* ctl_face_read(c, path, enrolment, w, out, found): Reads a file like ctl_face_parse() and builds its face.
 *   enrolment  applies the stricter gate of enrolments
 *   out        the face, to be released by surface_face_free()
 *   found      see sample.h
 * A failure is in c->e, with the path. */
enum status ctl_face_read(struct ctl *c, const char *path, bool enrolment,
                          struct surface_work *w, struct surface_face **out,
                          struct sample_found *found);

/* ctl_face_warnings(to, label, f): Prints a line like "warnings     occluded, turned", which begins with the
 * label; nothing if there are no warnings. */
void ctl_face_warnings(FILE *to, const char *label, const struct sample_found *f);

/* ctl_face_context(c, w): Returns the context of comparisons with c's database and w. */
struct templates_context ctl_face_context(struct ctl *c, struct surface_work *w);

/* ctl_face_passed_over(t): Reports on standard error that a template was left out, if one was. */
void ctl_face_passed_over(const struct templates *t);

/* ctl_face_exit(d): Returns the exit code of a decision. */
int ctl_face_exit(enum surface_decision d);

/* Print lines of a comparison. */
void ctl_face_score(FILE *to, const struct surface_comparison *r);
void ctl_face_minimal(FILE *to, const struct surface_disparity *d);
void ctl_face_scan(FILE *to, const struct surface_face *f);
void ctl_face_regions(FILE *to, const struct surface_parts *p);
void ctl_face_alignment(FILE *to, const struct surface_disparity *a);

/* ctl_face_reasons(to, f): Prints the end of a line, "" or " (noisy)". */
void ctl_face_reasons(FILE *to, const struct surface_face *f);

#endif
