/* verify.h -- a verification, and a comparison of two scans: one function for daemon and command.
 * It reads the store in one transaction, and writes to it in another one.  It reports a result only
 * after it has counted and recorded the attempt: otherwise the number of attempts had no limit. */
#ifndef SERVICE_VERIFY_H
#define SERVICE_VERIFY_H
#include <stdatomic.h>
#include "describe.h"
#include "sample.h"
#include "templates.h"

struct session; /* session.h */
struct show;    /* show.h */

enum verify_detail { /* extent of the result; each level includes the one above it */
                     VERIFY_DECISION, /* the decision and the ids only */
                     VERIFY_BRIEF, /* numbers from which no template can be reconstructed */
                     VERIFY_MEASURE, /* the disparity measure, the pose and the regions */
                     VERIFY_SURFACE, /* the surfaces, for verify_show() */
                     VERIFY_HEATMAP  /* the gap at each point, instead of the surfaces */
};

/* Of each scan the face goes to *face or *other_face, which the caller owns. */
struct verify_request {
    struct templates_of of; /* templates to compare with; unused if other is set */
    struct session *probe;  /* scan to be verified; borrowed until verify_free() */
    struct session *other;  /* scan instead of a template, or NULL; not recorded */
    struct surface_face **face, **other_face;
    enum verify_detail detail; /* extent of the result */
    bool
        scores; /* the actor may know the score of a scan that does not match, and that of one that
                    does with all digits (describe_comparison.coarse) */
    const char *captured;    /* text after the outcome in the event; NULL: none */
    const atomic_bool *stop; /* cancellation flag, set by another thread; may be NULL */
};

struct verification {
    struct verify_request *request;   /* borrowed until verify_free() */
    struct templates templates;       /* templates of the subject, read from the store */
    struct templates_refusal refusal; /* reason of ST_EDENIED */
    struct templates_nearest best;    /* comparison with the best template */
    /* Minimal disparity; zero for VERIFY_DECISION, and for a non-match without scores. */
    struct surface_disparity least;
    struct surface_parts parts; /* parts of the score, for VERIFY_MEASURE and higher */
    double *gap; /* gap of each point of the probe as read, NAN: none; or NULL */
    struct store_recorded recorded; /* result of recording the attempt */
    bool decided; /* the decision is recorded; a later error is still an attempt */
    struct describe_times times; /* times of the steps; total is unset */
};

/* verify_run(c, r, v, e): Compares the probe with the templates, and records the decision.  Without a
 * store (c->store is NULL) only r->other can be used; the model's own calibration decides then.
 *   v  to be released by verify_free(), also after a failure
 * Returns ST_OK, or:
 *   ST_EDENIED     v->refusal has the reason
 *   ST_ENOTFOUND   there is no template
 *   ST_EREPLAYED, ST_EMIRRORED
 *   ST_EBUSY       *r->stop is set
 *   or, for a scan, as session_read() and session_build();
 *   or as templates_read(), templates_nearest(), store_record_verification(). */
enum status verify_run(struct templates_context *c, struct verify_request *r,
                       struct verification *v, struct errinfo *e);

/* verify_free(v): Releases the templates of v and the gap. */
void verify_free(struct verification *v);

/* verify_describe(v, engine): Returns the result of v, for describe_comparison().  Its pointers are borrowed
 * until verify_free(v). */
struct describe_comparison verify_describe(const struct verification *v,
                                           const char *engine);

/* verify_show(v, j, out): Draws the template that decided with the probe over it, after a verification with
 * VERIFY_SURFACE.
 *   j  as in show_comparison()
 * Returns ST_OK; ST_ENOMEM. */
enum status verify_show(const struct verification *v, struct json *j, struct show *out);

/* verify_spread(c, value): Moves the values of the points of c to the positions of the points as sent.
 *   value  capacity c->read; in: one value for each of the c->n points; out: one for each point sent,
 *          NAN for the dropped points */
void verify_spread(const struct cloudpoints *c, double *value);

#endif
