/* describe.h -- subjects, templates and comparisons as JSON, the same from daemon and
 * command.  Each writes members into the object that is open in j (base/json.h; NULL: nothing
 * is done).  What is not known or was not given is null. */
#ifndef SERVICE_DESCRIBE_H
#define SERVICE_DESCRIBE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"

struct enrolment_result; /* enrolment.h */
struct json;             /* json.h */
struct sample_found;     /* sample.h */
struct session;          /* session.h */
struct store_receipt;    /* store.h */
struct store_subject;    /* store.h */
struct store_template;   /* store.h */
struct store_token;      /* store.h */
struct store_worst;      /* store.h */
struct dry_run;          /* dry_run.h */

/* describe_quality(j, key, q, face): an object; face: of the scan, for the reasons; NULL: it is
 * not at hand. */
void describe_quality(struct json *j, const char *key, const struct surface_quality *q,
                      const struct surface_face *face);

/* describe_scan(j, key, f): an object: what was found in a scan's file, and taken; format and
 * warnings as stable words. */
void describe_scan(struct json *j, const char *key, const struct sample_found *f);

/* describe_subject(j, s): everything but its templates. */
void describe_subject(struct json *j, const struct store_subject *s);

/* describe_subject_row(j, s): the same in a list of store_subject_search().
 * describe_attempts(j, a): of a subject; an object. */
void describe_subject_row(struct json *j, const struct store_subject *s);
void describe_attempts(struct json *j, const struct store_worst *a);

/* describe_scopes(j, scopes): an array of their names.
 * describe_token(j, t, secret): secret: a new one, which is shown this once; NULL: left out. */
void describe_scopes(struct json *j, unsigned scopes);
void describe_token(struct json *j, const struct store_token *t, const char *secret);
const char *describe_token_state(const struct store_token *t);

/* describe_receipt(j, r): of an erasure, in full. */
void describe_receipt(struct json *j, const struct store_receipt *r);

/* describe_template(j, t, face, how): face as above.  how: also by whom and how far from the first
 * it was enrolled, for those alone who may know scores. */
void describe_template(struct json *j, const struct store_template *t,
                       const struct surface_face *face, bool how);

/* describe_enrolled(j, file, x, found, face): a file of several that were sent to be enrolled:
 * the template that it is now, or the refusal.  found: points_read is 0 where it was not read.
 * face: not used where x was refused. */
void describe_enrolled(struct json *j, const char *file, const struct enrolment_result *x,
                       const struct sample_found *found, const struct surface_face *face);

/* ms; NAN: not measured, null in JSON.  align: for the minimal disparity. */
struct describe_times {
    double parse, prepare, score, align, minimal, total;
};

struct describe_comparison {
    const struct surface_comparison *result;
    /* NULL: no number of the comparison is told */
    const struct surface_disparity *minimal;
    const struct surface_face *probe; /* NULL: the decision and the ids alone */
    const struct sample_found *scan;  /* the probe's; NULL: left out */
    const struct session *frames; /* that the probe was fused from; NULL: it was not */
    const struct sample_found
        *other; /* of what is compared with it in a template's place;
                                         NULL: that is a template */
    const struct surface_face *other_face; /* with it */
    const char *engine;                    /* surface_engine() */
    const char *subject, *template_id;     /* NULL: null */
    uint32_t templates_compared;
    /* with what minimal is made of, for which it has been weighed (surface_weigh()), the alignment
     * and the regions; NULL: without */
    const struct surface_parts *parts;
    const double *gap_mm; /* the heatmap, NaN where there is none; NULL: not asked for */
    size_t n;
    const struct describe_times *times; /* NULL: left out */
};

void describe_comparison(struct json *j, const struct describe_comparison *c);

/* describe_cells(j, p): what each cell added to the score, by rows from the lower left, and where
 * the cells are. */
void describe_cells(struct json *j, const struct surface_parts *p);

/* describe_asymmetry(j, a, f, engine, times): of face f; of times score and align are not used. */
void describe_asymmetry(struct json *j, const struct surface_asymmetry *a,
                        const struct surface_face *f, const char *engine,
                        const struct describe_times *times);

/* describe_dry_run(j, t, face, times): of a scan, after dry_run_run(), which made the face.  Of times only parse,
 * prepare and total are used. */
void describe_dry_run(struct json *j, const struct dry_run *t,
                      const struct surface_face *face,
                      const struct describe_times *times);

#endif
