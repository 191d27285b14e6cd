/* render.h -- what the daemon responds, as JSON.
 * Texts returned are heap, NUL-terminated, released by free(); NULL: out of memory. */
#ifndef SERVER_RENDER_H
#define SERVER_RENDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "store.h"

struct asymmetry;
struct errmap;
struct face;
struct face_result;
struct frame;

/* render_problem(m, detail, request_id, mismatch): RFC 9457; mismatch may be NULL: the
 * comparison that is told with it. */
char *render_problem(const struct errmap *m, const char *detail, const char *request_id,
                     const struct face_result *mismatch);

struct render_verdict {
    const struct face_result *result;
    const struct face *probe;
    const char *engine;                /* face_engine() */
    const char *subject, *template_id; /* NULL: null */
    uint32_t templates_compared;
    double parse_ms, prepare_ms, align_ms, measure_ms, total_ms;
    bool measure;         /* with the measure, the alignment and the regions */
    const double *gap_mm; /* the heatmap, NaN where there is none; NULL: not asked for */
    size_t n;
};

char *render_verdict(const struct render_verdict *v);

struct render_asymmetry {
    const struct asymmetry *result;
    const struct face *face;
    const char *engine; /* face_engine() */
    double parse_ms, prepare_ms, measure_ms, total_ms;
};

char *render_asymmetry(const struct render_asymmetry *v);

/* render_template(t, frame): frame: of the scan, for the reasons of its quality; NULL: it
 * is not at hand. */
char *render_template(const struct store_template *t, const struct frame *frame);
char *render_subject(const struct store_subject *s, const struct store_template *t,
                     size_t n);

/* render_subjects(s, n, more): one page; more: another one follows. */
char *render_subjects(const struct store_subject *s, size_t n, bool more);
char *render_erased(const struct store_receipt *r);
char *render_state(const char *state);                 /* {"status": state} */
char *render_ready(const struct store_calibration *k); /* {"status": "ready", ...} */
char *render_version(const char *version, const char *engine, const char *compiler);

#endif
