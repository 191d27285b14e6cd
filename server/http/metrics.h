/* metrics.h -- metrics for Prometheus (exposition format 0.0.4).  Any thread may count.
 * Base units (seconds, bytes); no label names a person, a token or an address.
 * Anyone who reaches the daemon can read them: they tell what it does, not how it is configured,
 * nor how much is enrolled. */
#ifndef SERVER_METRICS_H
#define SERVER_METRICS_H
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"
#include "status.h"

struct json; /* json.h */
struct metrics;
struct request;
struct route;
struct worker;

/* metrics_new(routes, nroutes): routes is borrowed.  NULL: out of memory. */
struct metrics *metrics_new(const struct route *routes, size_t nroutes);
void metrics_free(struct metrics *m);

/* metrics_request(m, r, http, ms): r came to its end after ms; http: the status that was
 * sent, 0 when the client was gone.  Its route and stages count, a token or a scan
 * that was refused, and a failure of the store. */
void metrics_request(struct metrics *m, const struct request *r, int http, double ms);

/* metrics_decision(m, d): a verification or comparison was decided. */
void metrics_decision(struct metrics *m, enum surface_decision d);

enum metrics_enrollment {
    METRICS_ENROLLED,
    METRICS_KNOWN,   /* this very cloud is the subject's already */
    METRICS_MISMATCH /* it does not fit the subject's others */
};

void metrics_enrollment(struct metrics *m, enum metrics_enrollment outcome);

/* metrics_refused(m, st): of several files that were sent one was refused, by dry_run_is_refusal();
 * any other status is not counted. */
void metrics_refused(struct metrics *m, enum status st);

enum metrics_check {
    METRICS_ENROLLABLE, /* and so usable for verification too */
    METRICS_USABLE,
    METRICS_UNUSABLE
};

void metrics_check(struct metrics *m, enum metrics_check outcome);

/* metrics_capture(m, problem): a capture was taken (0), or refused by ERRMAP_CAPTURE_REQUIRED to
 * ERRMAP_LIVENESS. */
void metrics_capture(struct metrics *m, unsigned problem);

enum metrics_failed { METRICS_OF_TOKEN, METRICS_OF_OTHERS, METRICS_OF_SUBJECTS };
enum metrics_warning {
    METRICS_LOCKED_OUT,
    METRICS_MANY_SUBJECTS,
    METRICS_ATTEMPTS_PATTERN,
    METRICS_WARNINGS
};

/* metrics_attempts(m, which): a verification was refused for failed ones before it, of the token
 * for the subject, of other tokens, or of the token for other subjects.
 * metrics_warning(m, kind): the operator should look who fails. */
void metrics_attempts(struct metrics *m, enum metrics_failed which);
void metrics_warning(struct metrics *m, enum metrics_warning kind);

/* metrics_database_error(m, st): counts st if it is a failure of the store (and not, say,
 * ST_ENOTFOUND). */
void metrics_database_error(struct metrics *m, enum status st);

/* metrics_rows_verified(m): just now, against the change log. */
void metrics_rows_verified(struct metrics *m);

/* metrics_lost_event(m): an event could not be written to the store. */
void metrics_lost_event(struct metrics *m);

/* metrics_tokens(m, soon, left_s): soon tokens expire soon, the first of all in left_s s;
 * INT64_MAX: none does. */
void metrics_tokens(struct metrics *m, uint64_t soon, int64_t left_s);

/* metrics_describe(m, j): uptime_s, rates and latency_ms, for those who may know more than a
 * stranger, as members of the object that is open in j.  Quantiles lie within a bucket of their
 * histogram, in proportion. */
void metrics_describe(const struct metrics *m, struct json *j);

void metrics_handle(struct request *r, struct worker *w); /* GET /metrics */

#endif
