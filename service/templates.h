/* templates.h -- the templates that a probe is compared with: may the subject be verified
 * or enrolled now, what are its templates, and which of them decides?  All is read, with
 * the faces, in one transaction of the store, so that no template is compared that was
 * deleted before it. Fusion: the comparison with the highest score decides, so that one
 * matching template suffices; an inconclusive one only where there is no other.  Each
 * score is lowered by the logarithm of the number of templates (surface_best_of()), so
 * that several templates do not raise the false match rate. A non-match is also compared
 * as its mirror image: a scanner that swaps left and right. */
#ifndef SERVICE_TEMPLATES_H
#define SERVICE_TEMPLATES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "errinfo.h"
#include "libsurface.h"
#include "status.h"
#include "store.h"

struct cache;      /* cache.h */
struct cache_held; /* cache.h */

/* What compares.  One thread at a time. */
struct templates_context {
    struct store *store;
    struct surface_work *work;
    struct cache *cache;      /* of decoded faces; NULL: none */
    int64_t calibration;      /* the version that work decides by; 0 for a new work */
    double (*clock_ms)(void); /* for the times; may be NULL */
};

struct templates_of {
    const char *subject;               /* or NULL and */
    const char *template_id;           /* this one alone */
    const char *token;                 /* whose attempts; NULL: "" */
    const struct store_limits *limits; /* NULL: none */
};

enum templates_admit { TEMPLATES_ADMITTED, TEMPLATES_DISABLED, TEMPLATES_EXPIRED };

struct templates_refusal { /* of ST_EDENIED; all 0: it was not */
    enum templates_admit admit;
    enum store_wait why; /* not STORE_WAIT_NONE: locked out, */
    int64_t wait_ms;     /* for so long, */
    struct store_attempts now;
};

struct templates {
    struct templates_context *context;
    struct store_snapshot of;
    struct templates_refusal refusal;
    const struct surface_face
        *face[STORE_TEMPLATES_MAX]; /* NULL: of another engine, which this one
                                                     cannot re-encode */
    const struct cache_held *held[STORE_TEMPLATES_MAX]; /* NULL: the face is another's */
    struct errinfo passed_over; /* the last of those; ST_OK: none */
};

/* templates_read(c, ask, out, e): read the templates; c->work decides by the calibration
 * in force.  Returns ST_OK; ST_EDENIED: out->refusal says why; or as
 * store_snapshot_begin(), store_snapshot_face().  A subject without a template is
 * admitted, whatever the limits.
 * templates_free(t): also after a failure; t is empty again. */
enum status templates_read(struct templates_context *c, const struct templates_of *ask,
                           struct templates *out, struct errinfo *e);
void templates_free(struct templates *t);

struct templates_nearest {
    struct surface_comparison result;
    size_t index;       /* which of the templates */
    uint32_t compared;  /* how many there were */
    double first_score; /* against the oldest of them, not lowered */
    bool mirrored;      /* no match, but its mirror image is one: templates_judge() */
    double score_ms;    /* for all templates */
};

/* templates_nearest(t, fit, probe, out, e): compare the probe with the templates, except
 * those of another engine.
 * fit    only with those that a further sample must match: the oldest, and those that were
 *        enrolled with scope manage (enrolment.h says why)
 * Returns ST_OK; ST_ENOTFOUND: there is none; ST_EVERSION: none but of another engine;
 * ST_ENOMEM. */
enum status templates_nearest(const struct templates *t, bool fit,
                              const struct surface_face *probe,
                              struct templates_nearest *out, struct errinfo *e);

/* templates_decision(d): "match", "no_match", "inconclusive". */
const char *templates_decision(enum surface_decision d);

/* templates_judge(n, e): ST_EMIRRORED, and *e for the user, if the scan is a mirror
 * image; else ST_OK. It reveals as much as a match: count it as a failed attempt before
 * reporting it. */
enum status templates_judge(const struct templates_nearest *n, struct errinfo *e);

/* templates_minimal(t, probe, of, out, parts, e): the minimal disparity against the template that
 * decides, and the alignment; with parts also by the weight of each place (surface_weigh()), and
 * what the score is made of; NULL: without.  Returns ST_OK, ST_ENOMEM. */
enum status templates_minimal(const struct templates *t, const struct surface_face *probe,
                              const struct templates_nearest *of,
                              struct surface_disparity *out, struct surface_parts *parts,
                              struct errinfo *e);

#endif
