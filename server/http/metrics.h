/* metrics.h -- metrics for Prometheus (exposition format 0.0.4).  Any thread may count.
 * Units are seconds and bytes.  No label names a person, a token or an address.  A client without the scope
 * audit reads only the state of process, queue, connections, database and certificate. */
#ifndef SERVER_METRICS_H
#define SERVER_METRICS_H
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"
#include "status.h"
#include "store.h"

struct json; /* json.h */
struct metrics;
struct request;
struct route;
struct worker;

/* metrics_new(routes, nroutes): Creates the counters, all 0.
 *   routes  borrowed until metrics_free()
 * Returns NULL: out of memory. */
struct metrics *metrics_new(const struct route *routes, size_t nroutes);

/* metrics_free(m): Frees m; NULL is allowed. */
void metrics_free(struct metrics *m);

/* metrics_request(m, r, http, ms): Counts a request that has ended: its route and status, the time of its stages,
 * its capture, a refused token or scan, and a failure of the database.
 *   http  the status sent; 0: the client had disconnected
 *   ms    time from its start to its end */
void metrics_request(struct metrics *m, const struct request *r, int http, double ms);

enum metrics_event {
    METRICS_DECISIONS, /* verifications and comparisons, by enum surface_decision */
    METRICS_IDENTIFIED = METRICS_DECISIONS + SURFACE_INCONCLUSIVE + 1, /* likewise */
    METRICS_ENROLLED = METRICS_IDENTIFIED + SURFACE_INCONCLUSIVE + 1,
    METRICS_KNOWN,      /* an enrolled scan that the subject had already */
    METRICS_MISMATCH,   /* a sample that does not match the reference template */
    METRICS_ENROLLABLE, /* a checked scan, usable for verification too */
    METRICS_USABLE,     /* a checked scan, usable for verification only */
    METRICS_UNUSABLE,
    METRICS_REFUSED_ATTEMPTS, /* refusals for failed attempts, from STORE_WAIT_OWN on */
    METRICS_WARNINGS = METRICS_REFUSED_ATTEMPTS + 3,  /* by the bits of warnings */
    METRICS_LOST = METRICS_WARNINGS + STORE_WARNINGS, /* an event that was not stored */
    METRICS_EVENTS
};

/* metrics_event(m, e): Counts one event of enum metrics_event. */
void metrics_event(struct metrics *m, unsigned e);

/* metrics_decision(m, decision, score): Counts the decision of a verification or comparison, and its score. */
void metrics_decision(struct metrics *m, enum surface_decision decision, double score);

/* metrics_refused(m, st): Counts a refused scan of several; a st for which dry_run_is_refusal() is false is not
 * counted. */
void metrics_refused(struct metrics *m, enum status st);

/* metrics_database_error(m, st): Counts st if it is a failure of the database. */
void metrics_database_error(struct metrics *m, enum status st);

/* metrics_rows_verified(m): Records that the rows were verified against the change log at this moment. */
void metrics_rows_verified(struct metrics *m);

/* metrics_tokens(m, soon, left_s): Sets the number of tokens that expire soon, and the time until the first token
 * expires, s; INT64_MAX: none expires. */
void metrics_tokens(struct metrics *m, uint64_t soon, int64_t left_s);

/* metrics_describe(m, j): Writes uptime_s, rates and latency_ms into the object that is open in j.  A quantile is
 * interpolated within a bucket of its histogram. */
void metrics_describe(const struct metrics *m, struct json *j);

/* metrics_handle(r, w): GET /metrics. */
void metrics_handle(struct request *r, struct worker *w);

#endif
