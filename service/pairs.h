/* pairs.h -- the templates of a subject compared with each other: does one of them not fit the others, because
 * it is of another person, or of a bad sitting?  For daemon and command. */
#ifndef SERVICE_PAIRS_H
#define SERVICE_PAIRS_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include "templates.h"

struct json; /* json.h */

#define PAIRS_MAX (STORE_TEMPLATES_MAX * (STORE_TEMPLATES_MAX - 1) / 2)

enum pairs_fit {                /* of a template to the others */
                 PAIRS_UNKNOWN, /* no comparison of it has a decision */
                 PAIRS_FITS, /* it matches at least as many of the others as it does not match */
                 PAIRS_MISFIT /* it matches fewer of them than it does not match */
};

struct pairs_one { /* a comparison of two templates */
    uint32_t a, b; /* their indices, a < b */
    struct surface_comparison result;
};

struct pairs {
    struct templates templates;
    struct pairs_one one[PAIRS_MAX]; /* [n] in the order of a, then of b */
    uint32_t n;
    uint32_t matches[STORE_TEMPLATES_MAX]; /* how many of the others it matches */
    enum pairs_fit fit[STORE_TEMPLATES_MAX];
};

/* pairs_run(c, subject, token, stop, out, e): Compares each two of the subject's templates.  A pair decides as if the
 * newer template were a scan that is verified by the older one alone.  Stores nothing, and counts no attempt.  Leaves
 * out a template whose face is NULL.
 *   token  actor, borrowed until pairs_free(); it sees the subjects of its groups
 *   stop   cancellation flag, set by another thread; may be NULL
 *   out    to be released by pairs_free(), also after a failure
 * Cost: 0.3 ms a pair; that of a minimal disparity for a pair of two people.
 * Returns ST_OK; ST_ENOTFOUND: no such subject, or a template was deleted meanwhile; ST_EBUSY: *stop is set; or as
 * templates_read(), templates_pair(). */
enum status pairs_run(struct templates_context *c, const char *subject, const char *token,
                      const atomic_bool *stop, struct pairs *out, struct errinfo *e);

void pairs_free(struct pairs *p);

/* pairs_describe(j, p, scores, engine): Writes the templates and the pairs.
 *   scores  also write the scores, else null: only for clients that may know scores
 *   engine  surface_engine() */
void pairs_describe(struct json *j, const struct pairs *p, bool scores,
                    const char *engine);

#endif
