/* ctl_face.h -- a face compared with a subject's templates, and the comparison as text. */
#ifndef CTL_FACE_H
#define CTL_FACE_H
#include <stdio.h>
#include "enrolment.h"
#include "face.h"
#include "minimal.h"
#include "nearest.h"
#include "store.h"

struct ctl; /* ctl.h */

/* ctl_face_nearest(c, subject, probe, best): the probe compared with a subject's
 * templates, by the database's calibration (nearest_find()).  ST_EDENIED: the subject may
 * not be verified.  ctl_face_template(): with one template of it. */
struct ctl_nearest {
    struct nearest nearest;
    struct minimal minimal;     /* against the template that decides, weighed */
    struct store_template tmpl; /* that decides */
    struct store_subject subject;
};
enum status ctl_face_nearest(struct ctl *c, const char *subject, const struct face *probe,
                             struct ctl_nearest *best);
enum status ctl_face_template(struct ctl *c, const char *id, const struct face *probe,
                              struct ctl_nearest *best);

/* ctl_face_enroll(c, x, w, each, out): enrolment_add(). */
enum status ctl_face_enroll(struct ctl *c, const struct enrolment *x, struct face_work *w,
                            struct enrolment_result *each, struct enrolment_outcome *out);

/* ctl_face_subject(c, id, where): is the id one?  where begins what c->e says; ST_EINVAL. */
enum status ctl_face_subject(struct ctl *c, const char *id, const char *where);

int ctl_face_exit(enum face_decision d);

/* Parts of a comparison as text: lines; of the reasons the rest of one, "" or " (noisy)"; how
 * well a pose is known, without its end. */
void ctl_face_known(FILE *to, double turn_deg, double shift_mm);
void ctl_face_score(FILE *to, const struct face_result *r);
void ctl_face_minimal(FILE *to, const struct minimal *m);
void ctl_face_scan(FILE *to, const struct face *f);
void ctl_face_regions(FILE *to, const struct face_result *r);
void ctl_face_alignment(FILE *to, const struct align_result *a);
void ctl_face_reasons(FILE *to, const struct face *f);

#endif
