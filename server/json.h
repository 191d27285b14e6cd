/* json.h -- JSON in (json_read.c) and out (json.c).  Nothing else of the daemon knows the
 * JSON library.
 * Texts returned are heap, NUL-terminated, released by free(); NULL: out of memory.
 * Numbers are printed with as many digits as it takes to read the same double again. */
#ifndef SERVER_JSON_H
#define SERVER_JSON_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "store.h"
#include "vec.h"

struct asymmetry;
struct errinfo;
struct errmap;
struct frame;
struct face;
struct face_result;

struct json_cloud {
    struct dvec3 *pts; /* in their own unit; released by mem_free() */
    size_t n;
    double mm;      /* millimetres per unit */
    bool has_units; /* false: units was not given, and mm is 1 */
};

/* json_cloud_read(text, len, max_points, out, e): {"points": [[x,y,z],...], "units": "mm"}.
 * text  text[len] must be 0.
 * Strict where it matters: one document and nothing behind it, valid UTF-8, no key twice,
 * three finite numbers a point, no other members.  e tells what and where.
 * Memory: about 340 bytes a point while it reads; refused before that when there are more
 * values than max_points can need.
 * Returns ST_OK; ST_EINVAL malformed; ST_ENOTFINITE a number too large for a double;
 * ST_ELIMIT more than max_points; ST_ENOMEM.  On failure out is empty. */
enum status json_cloud_read(const char *text, size_t len, size_t max_points,
                            struct json_cloud *out, struct errinfo *e);

/* json_clouds_read(..., a, b, e): {"a": cloud, "b": cloud}, the same. */
enum status json_clouds_read(const char *text, size_t len, size_t max_points,
                             struct json_cloud *a, struct json_cloud *b,
                             struct errinfo *e);

/* json_units(name, mm): "mm", "cm", "m" to millimetres per unit; false: none of them. */
bool json_units(const char *name, double *mm);

#define JSON_TEXT_MAX 256

struct json_change {
    struct store_subject_change what; /* points into the rest, which is not to be moved */
    char consent[JSON_TEXT_MAX], purpose[JSON_TEXT_MAX], expires[JSON_TEXT_MAX];
    bool hold, disabled;
};

/* json_newcomer_read(text, len, out, e): a subject to be made: its id as subject, and consent,
 * purpose and expires_at, which may miss or be null; the rest as below. */
enum status json_newcomer_read(const char *text, size_t len, struct store_subject *out,
                               struct errinfo *e);

/* json_change_read(text, len, out, e): a merge patch (RFC 7396) of a subject: consent,
 * purpose, expires_at (texts, or null for none), hold and disabled.  text as above.
 * Nothing else may be in it: who means to hold is not to find out later that "on_hold" did
 * nothing.  Returns ST_OK; ST_EINVAL; ST_ENOMEM. */
enum status json_change_read(const char *text, size_t len, struct json_change *out,
                             struct errinfo *e);

/* json_problem(m, detail, request_id, mismatch): RFC 9457; mismatch may be NULL: the
 * comparison that is told with it. */
char *json_problem(const struct errmap *m, const char *detail, const char *request_id,
                   const struct face_result *mismatch);

struct json_verdict {
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

char *json_verdict(const struct json_verdict *v);

struct json_asymmetry {
    const struct asymmetry *result;
    const struct face *face;
    const char *engine; /* face_engine() */
    double parse_ms, prepare_ms, measure_ms, total_ms;
};

char *json_asymmetry(const struct json_asymmetry *v);

/* json_template(t, frame): frame: of the scan, for the reasons of its quality; NULL: it is
 * not at hand. */
char *json_template(const struct store_template *t, const struct frame *frame);
char *json_subject(const struct store_subject *s, const struct store_template *t,
                   size_t n);

/* json_subjects(s, n, more): one page; more: another one follows. */
char *json_subjects(const struct store_subject *s, size_t n, bool more);
char *json_erased(const struct store_receipt *r);
char *json_state(const char *state);                 /* {"status": state} */
char *json_ready(const struct store_calibration *k); /* {"status": "ready", ...} */
char *json_version(const char *version, const char *engine, const char *compiler);

#endif
