/* verify.h -- a probe against the templates of a subject, or against one template.
 * Fusion: of the comparisons that are conclusive the one with the lowest disparity is the
 * answer, so that one matching template suffices; where none is conclusive, the answer is
 * the inconclusive one with the greatest overlap. */
#ifndef SERVER_VERIFY_H
#define SERVER_VERIFY_H
#include <stddef.h>
#include <stdint.h>
#include "face.h"

struct errinfo;
struct request;
struct store_template;
struct worker;

struct verify_best {
    struct face_result result;
    size_t index;                /* which of the templates */
    uint32_t compared;           /* how many there were */
    double align_ms, measure_ms; /* over all of them */
};

/* verify_calibrate(w, e): let the worker decide by the calibration in force: before every
 * comparison that belongs to a request, so that a new one needs no restart. */
enum status verify_calibrate(struct worker *w, struct errinfo *e);

/* verify_compare(w, t, n, probe, out, e): by the calibration in force.  Templates deleted
 * meanwhile are left out.  Returns ST_OK; ST_ENOTFOUND: none was left; or as
 * store_template_load(), calibration_follow(). */
enum status verify_compare(struct worker *w, const struct store_template *t, size_t n,
                           const struct face *probe, struct verify_best *out,
                           struct errinfo *e);

void verify_subject(struct request *r, struct worker *w);
void verify_template(struct request *r, struct worker *w);

/* verify_event(r, kind, subject, template_id, decision): count the decision, and append
 * the event; when that fails the answer stands, and the log says that it is missing. */
void verify_event(struct request *r, const char *kind, const char *subject,
                  const char *template_id, enum face_decision decision);

#endif
