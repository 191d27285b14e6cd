/* identify.h -- an identification: one scan against all people of a gallery (1:N, docs/decision.md).
 * The search (gallery.h) names those most alike; they are compared exactly, by the numbers of a
 * verification, and admitted once more, all in one transaction of the store.  A match needs the threshold
 * for so many people (surface_search_threshold()).  The result is recorded before it is reported. */
#ifndef SERVICE_IDENTIFY_H
#define SERVICE_IDENTIFY_H
#include <stdatomic.h>
#include "describe.h"
#include "gallery.h"
#include "templates.h"

struct session; /* session.h */

#define IDENTIFY_MOST 50 /* most candidates of one identification */

struct identify_request {
    const char *actor; /* as in store_event() */
    const char *group; /* as in struct gallery_search */
    size_t candidates; /* most candidates to be listed, up to IDENTIFY_MOST */
    struct session *
        probe; /* the scan; borrowed until identify_free(); NULL: a sample of an enrolment */
    struct surface_face **face; /* receives its face, which the caller owns */
    const char *captured;       /* text after the outcome in the event; NULL: none */
    const atomic_bool *stop; /* cancellation flag, set by another thread; may be NULL */
};

struct identify_candidate {
    char subject[STORE_SUBJECT_MAX + 1];
    char template_id[STORE_ID_LEN + 1];
    struct surface_comparison result; /* as a verification decides */
};

struct identification {
    struct identify_request *request; /* borrowed until identify_free() */
    enum surface_decision decision;
    /* Comparison with the best subject, its threshold that for `searched` people; compared 0: nobody was
     * compared. */
    struct templates_nearest best;
    struct templates templates; /* of the best subject */
    double fpir;                /* false-positive identification rate at the score */
    bool extrapolated;          /* fpir is beyond what comparisons support */
    uint64_t seq;               /* number of the last change that the search has seen */
    uint64_t searched;          /* number of subjects searched */
    uint64_t skipped;           /* templates that could not be searched */
    uint32_t compared;          /* subjects compared exactly */
    bool unknown; /* too little of the face is known to search by: nobody was compared */
    struct identify_candidate candidate[IDENTIFY_MOST];
    size_t n;     /* number of candidates, the most alike first */
    bool decided; /* the decision is recorded */
    struct describe_times
        times; /* times of the steps; total, align and minimal are unset */
};

/* identify_run(c, g, r, x, e): Identifies the scan, and records the decision and each candidate.
 *   x  to be released by identify_free(), also after a failure
 * The same number of subjects is compared for every scan, so that the time says nothing of who is there.
 * Returns ST_OK, or:
 *   ST_EREPLAYED, ST_EMIRRORED, ST_EBUSY  as verify_run()
 *   ST_EDENIED     the actor is not bound to r->group
 *   or, for the scan, as session_read() and session_build();
 *   or as gallery_follow(), store_snapshot_begin(), store_event(). */
enum status identify_run(struct templates_context *c, struct gallery *g,
                         struct identify_request *r, struct identification *x,
                         struct errinfo *e);

/* identify_sample(c, g, r, x, e): The part of identify_run() that follows the building of the face: for the face of a
 * sample, which is known, so that r->probe is NULL.  The event says "enroll", and a mirror image is no error. */
enum status identify_sample(struct templates_context *c, struct gallery *g,
                            struct identify_request *r, struct identification *x,
                            struct errinfo *e);

/* identify_free(x): Releases the templates of x. */
void identify_free(struct identification *x);

/* identify_describe(j, x, brief, scores, engine): Writes the result into the open object.
 *   brief   only the decision and the ids
 *   scores  the client may know the numbers of a non-match, and those of a match with all digits */
void identify_describe(struct json *j, const struct identification *x, bool brief,
                       bool scores, const char *engine);

#endif
