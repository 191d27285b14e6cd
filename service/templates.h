/* templates.h -- the templates of a subject: admission of the subject, its templates and their faces, and
 * the choice of the template that decides.
 * All is read in one transaction of the store, so that no template is compared that was deleted before
 * it.  Fusion: the comparison with the highest score decides, so that one matching template suffices.
 * An inconclusive comparison decides only if all others are inconclusive too.  Each score is lowered by
 * the logarithm of the number of templates (surface_best_of()), so that several templates do not raise
 * the false match rate.  A probe that does not match is also compared as its mirror image, because some
 * scanners swap left and right. */
#ifndef SERVICE_TEMPLATES_H
#define SERVICE_TEMPLATES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "errinfo.h"
#include "libsurface.h"
#include "status.h"
#include "store.h"

/* The resources of a comparison.  One thread at a time. */
struct templates_context {
    struct store *store;
    struct surface_work *work;
    int64_t
        calibration; /* version of the calibration that work decides by; 0: work is new */
    double (*clock_ms)(void); /* clock for the times, ms; NULL: no times */
};

/* A request for the templates of a subject, or, if subject is NULL, for one template. */
struct templates_of {
    const char *subject;               /* id of the subject; NULL: template_id is set */
    const char *template_id;           /* id of the template, the only one that is read */
    const char *token;                 /* token whose failed attempts count; NULL: "" */
    const struct store_limits *limits; /* limits of attempts; NULL: no limits */
    /* Also admit a disabled or expired subject: nobody is verified or enrolled. */
    bool regardless;
};

enum templates_admit { TEMPLATES_ADMITTED, TEMPLATES_DISABLED, TEMPLATES_EXPIRED };

struct templates_refusal { /* reason of ST_EDENIED; all 0: admitted */
    enum templates_admit admit;
    enum store_wait why; /* reason of the lock-out; STORE_WAIT_NONE: not locked out */
    int64_t wait_ms;     /* remaining lock-out, ms; 0 if not locked out */
    struct store_attempts now; /* the failed attempts that were counted */
};

struct templates {
    struct templates_context *context;
    const char *token;        /* actor of the request, borrowed; "": none */
    struct store_snapshot of; /* the subject, its templates, attempts, calibration */
    struct templates_refusal refusal;
    /* Faces of the templates, without their surfaces until these are needed; NULL: of another engine, and
     * this one cannot re-encode it. */
    struct surface_face *face[STORE_TEMPLATES_MAX];
    struct errinfo passed_over; /* reason of the last NULL in face; ST_OK: none */
};

/* templates_read(c, ask, out, e): Reads the templates and their faces, and sets the calibration of c->work
 * to the one in force.  A subject without a template is admitted regardless of the limits.
 *   out  to be released by templates_free(), also after a failure
 * Returns ST_OK; ST_EDENIED: out->refusal has the reason; or as store_snapshot_begin(),
 * store_snapshot_face(). */
enum status templates_read(struct templates_context *c, const struct templates_of *ask,
                           struct templates *out, struct errinfo *e);

struct store_people; /* store_people.h */

/* templates_read_found(c, people, uid, token, out, e): Like templates_read(), for a subject that a search has found: within
 * its transaction, and without limits of attempts and a calibration.
 *   uid    [STORE_UID]
 *   token  actor of the request, borrowed */
enum status templates_read_found(struct templates_context *c, struct store_people *people,
                                 const unsigned char *uid, const char *token,
                                 struct templates *out, struct errinfo *e);

/* templates_free(t): Releases the templates; t is reset to the empty state. */
void templates_free(struct templates *t);

struct templates_nearest {
    struct surface_comparison result; /* comparison that decides, its score lowered */
    size_t index;                     /* index of the template that decides */
    uint32_t compared;                /* number of compared templates */
    double first_score;               /* score against the oldest of them, not lowered */
    bool
        mirrored; /* the probe does not match, but its mirror image does: templates_judge() */
    double score_ms; /* time of all comparisons, ms */
};

/* templates_compare(t, fit, probe, out, e): Compares the probe with the templates, except those with a NULL
 * face, and chooses the one that decides.
 *   fit  true: compare only with the reference templates, which a further sample must match: the oldest
 *        one, and those enrolled with scope manage (enrolment.h states the reason)
 * Returns ST_OK; ST_ENOTFOUND: there is no template, or the one whose surface is needed was deleted after
 * templates_read(); ST_EVERSION: all templates are of another engine,
 * and this one cannot re-encode them; ST_ENOMEM. */
enum status templates_compare(struct templates *t, bool fit,
                              const struct surface_face *probe,
                              struct templates_nearest *out, struct errinfo *e);

/* templates_doubt(t, probe, io, e): Looks at a non-match again: by the surface of the template that decides, and for
 * its mirror image.  Errors as templates_compare(). */
enum status templates_doubt(struct templates *t, const struct surface_face *probe,
                            struct templates_nearest *io, struct errinfo *e);

/* templates_nearest(t, fit, probe, out, e): Runs templates_compare() and templates_doubt(). */
enum status templates_nearest(struct templates *t, bool fit,
                              const struct surface_face *probe,
                              struct templates_nearest *out, struct errinfo *e);

/* templates_pair(t, i, k, out, e): Compares the face of template k, as a probe, with template i alone, as
 * templates_nearest() would.  Neither face is NULL.  Errors as templates_compare(). */
enum status templates_pair(struct templates *t, size_t i, size_t k,
                           struct surface_comparison *out, struct errinfo *e);

/* templates_decision(d): Returns "match", "no_match" or "inconclusive". */
const char *templates_decision(enum surface_decision d);

/* templates_judge(n, e): Returns ST_EMIRRORED, with a text for the user, if the scan is a mirror image, else
 * ST_OK.  The error reveals as much as a match: count a failed attempt before you report it. */
enum status templates_judge(const struct templates_nearest *n, struct errinfo *e);

/* templates_minimal(t, probe, of, out, parts, e): Computes the minimal disparity from the template that
 * decides, and the alignment.
 *   of     result of templates_nearest()
 *   parts  receives the parts of the score; *out then also has the weighted disparity
 *          (surface_weigh()); NULL: neither
 * Reads the surface of the template if it was not read so far.
 * Returns ST_OK; ST_ENOMEM; or as store_template_load(). */
enum status templates_minimal(struct templates *t, const struct surface_face *probe,
                              const struct templates_nearest *of,
                              struct surface_disparity *out, struct surface_parts *parts,
                              struct errinfo *e);

#endif
