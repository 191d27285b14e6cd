/* verify.h -- a verification, and a comparison of two scans: one function for daemon and command.
 * All that it reads of the store is one transaction, and so is all that it writes: what was not
 * counted and recorded is not reported, or there would be no limit. */
#ifndef SERVICE_VERIFY_H
#define SERVICE_VERIFY_H
#include <stdatomic.h>
#include "cloudfile.h"
#include "describe.h"
#include "sample.h"
#include "templates.h"

struct session; /* session.h */
struct show;    /* show.h */

enum verify_detail {                  /* what is wanted of a comparison */
                     VERIFY_DECISION, /* the decision and the ids alone */
                     VERIFY_BRIEF,    /* nothing from which a template could be rebuilt */
                     VERIFY_MEASURE,  /* the measure, the pose and the regions */
                     VERIFY_SURFACE,  /* and the surfaces, to be looked at */
                     VERIFY_HEATMAP   /* or the gap at each point */
};

struct verify_scan {
    const char *name;          /* begins what is said of it */
    unsigned char *bytes;      /* by mem_array(), taken; bytes[len] is 0; or NULL and */
    struct cloudpoints points; /* taken; or */
    struct session *frames;    /* those of several files, borrowed */
    size_t len;
    struct cloudfile_options how; /* to read bytes */
    bool axes_given;              /* or the file says so */
    bool frontal;                 /* where it does not: sample.h */
    struct surface_face **face;   /* receives it */
    struct sample_found found;    /* receives what was found */
};

struct verify_request {
    struct templates_of of; /* or */
    struct verify_scan
        *other; /* a scan in a template's place; nothing is recorded then */
    struct verify_scan probe;
    enum verify_detail detail;
    bool
        scores; /* who asks may know how much like a template one is that does not match */
    const char *captured;    /* follows in the event on its outcome; NULL for nothing */
    const atomic_bool *stop; /* another thread sets it where nobody wants the result */
};

struct verification {
    struct verify_request *request;
    struct templates templates;
    struct templates_refusal refusal;
    struct templates_nearest best;
    struct surface_disparity least; /* not for VERIFY_DECISION */
    struct surface_parts parts;     /* of VERIFY_MEASURE and what is more */
    double *
        gap; /* [request->probe.points.read] of VERIFY_HEATMAP, NAN where there is none */
    struct store_recorded recorded;
    bool decided; /* and recorded; what is refused after that is still an attempt */
    struct describe_times times; /* but total */
};

/* verify_run(c, r, v, e): the probe compared with the templates, the decision recorded.  Without a
 * store (of c) with another scan only, by the model's own calibration.
 * Returns ST_OK; ST_EDENIED: v->refusal says why; ST_ENOTFOUND: no template;
 * ST_EREPLAYED, ST_EMIRRORED; ST_EBUSY: r->stop is set; of the scan as cloudfile_read() and
 * sample_build(), but ST_EINVAL for ST_EVERSION; or as templates_read(), templates_nearest(),
 * store_record_verification().
 * verify_free(v): what v and its scans' points have, also after a failure. */
enum status verify_run(struct templates_context *c, struct verify_request *r,
                       struct verification *v, struct errinfo *e);
void verify_free(struct verification *v);

/* verify_describe(v, engine): the result of v for describe_comparison(), borrowed. */
struct describe_comparison verify_describe(const struct verification *v,
                                           const char *engine);

/* verify_show(v, j, out): the template that decided and the probe over it, after VERIFY_SURFACE;
 * j as of show_comparison().  Returns ST_OK, ST_ENOMEM. */
enum status verify_show(const struct verification *v, struct json *j, struct show *out);

/* verify_spread(c, value): value, with room for c->read, has one for each point of c; after
 * it one for each point that was sent, NAN for those that were dropped. */
void verify_spread(const struct cloudpoints *c, double *value);

#endif
