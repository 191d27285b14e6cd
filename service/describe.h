/* describe.h -- subjects, templates and comparisons as JSON, for daemon and command.
 * Each function writes members into the object that is open in j (base/json.h); if j is NULL, it does
 * nothing.  Unknown and missing values are null. */
#ifndef SERVICE_DESCRIBE_H
#define SERVICE_DESCRIBE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"

struct det;            /* det.h */
struct json;           /* json.h */
struct sample_found;   /* sample.h */
struct session;        /* session.h */
struct store_subject;  /* store.h */
struct store_template; /* store.h */
struct store_token;    /* store.h */
struct store_worst;    /* store.h */
struct dry_run;        /* dry_run.h */

/* describe_quality(j, key, q, face): Writes an object.
 *   face  of the scan, for the reasons; NULL: not available */
void describe_quality(struct json *j, const char *key, const struct surface_quality *q,
                      const struct surface_face *face);

/* describe_scan(j, key, f): Writes an object: the report on a scan's file and on the points used, with format
 * and warnings as stable words. */
void describe_scan(struct json *j, const char *key, const struct sample_found *f);

/* describe_subject(j, s): Writes all of a subject except its templates. */
void describe_subject(struct json *j, const struct store_subject *s);

/* describe_subject_row(j, s): Writes a subject in a list of store_subject_search(). */
void describe_subject_row(struct json *j, const struct store_subject *s);

/* describe_attempts(j, a): Writes an object: the failed attempts on a subject. */
void describe_attempts(struct json *j, const struct store_worst *a);

/* describe_scopes(j, scopes): Writes an array of the scopes' names. */
void describe_scopes(struct json *j, unsigned scopes);

/* describe_groups(j, list): Writes an array of the labels of a list (groups.h). */
void describe_groups(struct json *j, const char *list);

/* describe_token(j, t, secret): Writes a token.
 *   secret  a new secret, which is shown only once; NULL: left out */
void describe_token(struct json *j, const struct store_token *t, const char *secret);

/* describe_token_state(t): Returns "revoked", "expired" or "valid". */
const char *describe_token_state(const struct store_token *t);

/* describe_template(j, t, face, how): Writes a template.
 *   face  as in describe_quality()
 *   how   also write whether it was enrolled with scope manage, and its score against the first template;
 *         only for clients that may know scores */
void describe_template(struct json *j, const struct store_template *t,
                       const struct surface_face *face, bool how);

/* Times of the steps, ms; NAN: not measured, null in JSON.  align: alignment for the minimal disparity. */
struct describe_times {
    double parse, prepare, score, align, minimal, total;
};

struct describe_comparison {
    const struct surface_comparison *result;
    const struct surface_disparity *minimal; /* NULL: no numbers are written */
    const struct surface_face *probe; /* its face; NULL: only the decision and the ids */
    const struct sample_found *scan;  /* report on the probe; NULL: left out */
    const struct session *frames;     /* frames of the probe; NULL: it was one file */
    /* Report on the scan in the template's place, and its face; NULL: it is a template. */
    const struct sample_found *other;
    const struct surface_face *other_face;
    bool
        coarse; /* the score in steps of 0.1, the minimal disparity in steps of 0.001 mm */
    const char *engine;                /* surface_engine() */
    const char *subject, *template_id; /* ids; NULL: null in JSON */
    uint32_t templates_compared;       /* number of compared templates */
    /* Parts of the score, written with the parts of minimal (weighed by surface_weigh()), the alignment
     * and the regions; NULL: left out. */
    const struct surface_parts *parts;
    const double *gap_mm;               /* heatmap, NaN: no gap; NULL: left out */
    size_t n;                           /* number of values in gap_mm */
    const struct describe_times *times; /* NULL: left out */
};

/* describe_comparison(j, c): Writes the result of a verification or of a comparison. */
void describe_comparison(struct json *j, const struct describe_comparison *c);

/* describe_cells(j, p): Writes each cell's part of the score, by rows from the lower left, and the positions
 * of the cells. */
void describe_cells(struct json *j, const struct surface_parts *p);

/* describe_det(j, key, d): Writes an object: the people that it rests on, and the curve.
 *   d  NULL: null */
void describe_det(struct json *j, const char *key, const struct det *d);

/* describe_asymmetry(j, a, f, engine, times): Writes the asymmetry of face f.
 *   times  score and align are not used */
void describe_asymmetry(struct json *j, const struct surface_asymmetry *a,
                        const struct surface_face *f, const char *engine,
                        const struct describe_times *times);

/* describe_dry_run(j, t, face, times): Writes the result of dry_run_run(), which has built the face.
 *   times  only parse, prepare and total are used */
void describe_dry_run(struct json *j, const struct dry_run *t,
                      const struct surface_face *face,
                      const struct describe_times *times);

#endif
