/* ctl_face.h -- a scan's file as a face; a face compared with a subject's templates, and the
 * comparison as text. */
#ifndef CTL_FACE_H
#define CTL_FACE_H
#include <stdbool.h>
#include <stdio.h>
#include "describe.h"
#include "libsurface.h"
#include "sample.h"
#include "store.h"
#include "templates.h"

struct cloudpoints; /* cloudpoints.h */
struct ctl;         /* ctl.h */
struct json;        /* json.h */

/* ctl_face_read(c, path, enrolment, w, out, found): the face in a file ("-": standard input), read as
 * c->scans says.  enrolment: by the strict gate.  Every failure is in c->e, with the path.
 * ctl_face_parse(), ctl_face_build(): the same in two steps, for callers that need the points
 * or what was found (sample.h); cloudpoints_free() (empty on failure). */
enum status ctl_face_read(struct ctl *c, const char *path, bool enrolment,
                          struct surface_work *w, struct surface_face **out,
                          struct sample_found *found);
enum status ctl_face_parse(struct ctl *c, const char *path, struct cloudpoints *out);
enum status ctl_face_build(struct ctl *c, const char *path, struct cloudpoints *p,
                           bool enrolment, struct surface_work *w,
                           struct surface_face **out, struct sample_found *found);

/* ctl_face_warnings(to, label, f): a line "warnings     occluded, turned", where "warnings" is
 * the label; nothing without any. */
void ctl_face_warnings(FILE *to, const char *label, const struct sample_found *f);

/* ctl_face_context(c, w): c's database, and w.
 * ctl_face_passed_over(t): the template of another engine that was left out, to standard error. */
struct templates_context ctl_face_context(struct ctl *c, struct surface_work *w);
void ctl_face_passed_over(const struct templates *t);

/* ctl_face_nearest(c, which, probe, best): the probe compared with a subject's templates, or one
 * of them, by the database's calibration (templates_nearest()).  ST_EDENIED: the subject may not
 * be verified. */
struct ctl_nearest {
    struct templates_nearest nearest;
    struct surface_disparity minimal; /* against the template that decides, weighed */
    struct surface_parts parts;
    struct store_template tmpl; /* that decides */
};
enum status ctl_face_nearest(struct ctl *c, const struct templates_of *which,
                             const struct surface_face *probe, struct ctl_nearest *best);

/* ctl_face_subject(c, id, where): is the id one?  where begins what c->e says; ST_EINVAL. */
enum status ctl_face_subject(struct ctl *c, const char *id, const char *where);

int ctl_face_exit(enum surface_decision d);

/* ctl_face_page(c, path, tmpl, x, j): Writes the page of a comparison with the probe c->args[1] to the file.
 *   tmpl  the face that the probe was compared with
 *   j     a document with the open member "extras", which has its side "a" (page_side(), page_file());
 *         takes ownership */
enum status ctl_face_page(struct ctl *c, const char *path,
                          const struct surface_face *tmpl,
                          const struct describe_comparison *x, struct json *j);

/* Parts of a comparison as text: lines; of the reasons the rest of one, "" or " (noisy)". */
void ctl_face_score(FILE *to, const struct surface_comparison *r);
void ctl_face_minimal(FILE *to, const struct surface_disparity *d);
void ctl_face_scan(FILE *to, const struct surface_face *f);
void ctl_face_regions(FILE *to, const struct surface_parts *p);
void ctl_face_alignment(FILE *to, const struct surface_disparity *a);
void ctl_face_reasons(FILE *to, const struct surface_face *f);

#endif
