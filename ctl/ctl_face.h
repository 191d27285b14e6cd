/* ctl_face.h -- a scan's file as a face; a face compared with a subject's templates, and the
 * comparison as text. */
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

/* ctl_face_warnings(to, label, f): a line "warnings     occluded, turned", where "warnings" is
 * the label; nothing without any. */
void ctl_face_warnings(FILE *to, const char *label, const struct sample_found *f);

/* ctl_face_context(c, w): c's database, and w.
 * ctl_face_passed_over(t): the template of another engine that was left out, to standard error. */
struct templates_context ctl_face_context(struct ctl *c, struct surface_work *w);
void ctl_face_passed_over(const struct templates *t);

/* ctl_face_subject(c, id, where): is the id one?  where begins what c->e says; ST_EINVAL. */
enum status ctl_face_subject(struct ctl *c, const char *id, const char *where);

int ctl_face_exit(enum surface_decision d);

/* Parts of a comparison as text: lines; of the reasons the rest of one, "" or " (noisy)". */
void ctl_face_score(FILE *to, const struct surface_comparison *r);
void ctl_face_minimal(FILE *to, const struct surface_disparity *d);
void ctl_face_scan(FILE *to, const struct surface_face *f);
void ctl_face_regions(FILE *to, const struct surface_parts *p);
void ctl_face_alignment(FILE *to, const struct surface_disparity *a);
void ctl_face_reasons(FILE *to, const struct surface_face *f);

#endif
