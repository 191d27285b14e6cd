/* describe.h -- subjects, templates and comparisons as JSON, the same from daemon and
 * command.  Each writes members into the object that is open in j (base/json.h; NULL: nothing
 * is done).  What is not known or was not given is null. */
#ifndef VERIFY_DESCRIBE_H
#define VERIFY_DESCRIBE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct asymmetry;        /* asymmetry.h */
struct calibration;      /* calibration.h */
struct enrolment_result; /* enrolment.h */
struct face;             /* face.h */
struct face_field;       /* face.h */
struct face_result;      /* face.h */
struct frame;            /* frame.h */
struct json;             /* json.h */
struct minimal;          /* minimal.h */
struct quality;          /* quality.h */
struct scan_found;       /* scan.h */
struct store_receipt;    /* store.h */
struct store_subject;    /* store.h */
struct store_template;   /* store.h */
struct dry_run;          /* dry_run.h */

/* describe_quality(j, key, q, frame): an object; frame: of the scan, for the reasons; NULL: it
 * is not at hand. */
void describe_quality(struct json *j, const char *key, const struct quality *q,
                      const struct frame *frame);

/* describe_scan(j, key, f): an object: what was found in a scan's file, and taken; format and
 * warnings as stable words. */
void describe_scan(struct json *j, const char *key, const struct scan_found *f);

/* describe_subject(j, s): everything but its templates. */
void describe_subject(struct json *j, const struct store_subject *s);

/* describe_receipt(j, r): of an erasure, in full. */
void describe_receipt(struct json *j, const struct store_receipt *r);

/* describe_template(j, t, frame, how): frame as above.  how: also by whom and how far from the first
 * it was enrolled, for those alone who may know scores. */
void describe_template(struct json *j, const struct store_template *t,
                       const struct frame *frame, bool how);

/* describe_enrolled(j, file, x, found, frame): a file of several that were sent to be enrolled:
 * the template that it is now, or the refusal.  found: points_read is 0 where it was not read.
 * frame: of its face; not used where x was refused. */
void describe_enrolled(struct json *j, const char *file, const struct enrolment_result *x,
                       const struct scan_found *found, const struct frame *frame);

/* ms; NAN: not measured, null in JSON.  align: for the minimal disparity. */
struct describe_times {
    double parse, prepare, score, align, minimal, total;
};

struct describe_comparison {
    const struct face_result *result;
    /* NULL: the decision and the ids alone; of the rest only subject and template_id
     * are used */
    const struct minimal *minimal;
    const struct face *probe;
    const struct scan_found *scan;  /* the probe's; NULL: left out */
    const struct scan_found *other; /* of what is compared with it in a template's place;
                                         NULL: that is a template */
    const struct face *other_face;  /* with it */
    const char *engine;             /* face_engine() */
    const char *subject, *template_id; /* NULL: null */
    uint32_t templates_compared;
    bool measure;         /* with what minimal is made of, for which it has been weighed
                     (face_weigh()), the alignment and the regions (face_regions()) */
    const double *gap_mm; /* the heatmap, NaN where there is none; NULL: not asked for */
    size_t n;
    const struct face_field *field;     /* NULL: not asked for */
    const struct describe_times *times; /* NULL: left out */
};

void describe_comparison(struct json *j, const struct describe_comparison *c);

/* describe_calibration(j, c): the threshold, and the share of other people's scores at or above
 * each of some scores. */
void describe_calibration(struct json *j, const struct calibration *c);

/* describe_cells(j, f): what each cell added to the score, by rows from the lower left, and where
 * the cells are. */
void describe_cells(struct json *j, const struct face_field *f);

/* describe_asymmetry(j, a, f, engine, times): of face f; of times score and align are not used. */
void describe_asymmetry(struct json *j, const struct asymmetry *a, const struct face *f,
                        const char *engine, const struct describe_times *times);

/* describe_dry_run(j, t, face, times): of a scan, after dry_run_run().  Of times only parse,
 * prepare and total are used. */
void describe_dry_run(struct json *j, const struct dry_run *t, const struct face *face,
                      const struct describe_times *times);

#endif
