/* nearest.h -- a probe against the templates of one subject: which of them decides.
 * Fusion: of the comparisons that are conclusive the one with the lowest score decides,
 * so that one matching template suffices; where none is conclusive, the inconclusive one with
 * the greatest overlap. */
#ifndef VERIFY_NEAREST_H
#define VERIFY_NEAREST_H
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "status.h"

struct errinfo;        /* errinfo.h */
struct store;          /* store.h */
struct store_template; /* store.h */

/* What compares, and where it gets models from.  One thread at a time. */
struct nearest_context {
    struct store *store;
    struct face_work *work;
    int64_t calibration;      /* that work decides by: calibration_follow() */
    double (*clock_ms)(void); /* as in face_compare(); may be NULL */
    /* hold(arg, id, w, out, e): the model of template id, valid until release(arg, *out).
     * Returns as store_template_load(). */
    enum status (*hold)(void *arg, const char *id, struct face_work *w,
                        const struct face **out, struct errinfo *e);
    void (*release)(void *arg, const struct face *f);
    /* pass_over(arg, e): a template of another engine, of no use to this one, was left out. */
    void (*pass_over)(void *arg, const struct errinfo *e);
    void *arg;
};

struct nearest {
    struct face_result result;
    size_t index;                /* which of the templates */
    uint32_t compared;           /* how many there were */
    double align_ms, measure_ms; /* over all of them */
};

/* nearest_calibrate(c, e): c->work decides by the calibration in force from now on.  Returns
 * as calibration_follow(). */
enum status nearest_calibrate(struct nearest_context *c, struct errinfo *e);

/* nearest_find(c, t, n, probe, out, e): the probe compared with t[0..n-1], which are one
 * subject's, by the calibration in force.  Templates that were deleted since they were listed
 * are left out, and those of another engine that this one cannot re-encode.
 * Returns ST_OK; ST_ENOTFOUND: none was left; ST_EVERSION: none but of another engine; or as
 * hold(), calibration_follow(), face_compare(). */
enum status nearest_find(struct nearest_context *c, const struct store_template *t,
                         size_t n, const struct face *probe, struct nearest *out,
                         struct errinfo *e);

#endif
