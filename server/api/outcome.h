/* outcome.h -- the one place that reports the outcome of a verification or an enrolment: to the log, the metrics,
 * the list of recent requests (recent.h) and, if it is a refusal, to the client. */
#ifndef SERVER_OUTCOME_H
#define SERVER_OUTCOME_H
#include <stddef.h>
#include "enrolment.h"
#include "identify.h"
#include "status.h"
#include "verify.h"

struct errinfo; /* errinfo.h */
struct request; /* request.h */

/* outcome_refuse(r, why, e): Responds that the subject cannot be verified or enrolled.
 *   why  reason of ST_EDENIED: the subject is disabled, expired or locked out (with Retry-After); all 0: e */
void outcome_refuse(struct request *r, const struct templates_refusal *why,
                    const struct errinfo *e);

/* outcome_verified(r, v, st): Reports the result st and v of verify_run(), except to the client.  A comparison of
 * two scans is recorded in the audit log; if that fails, the response stands. */
void outcome_verified(struct request *r, const struct verification *v, enum status st);

/* outcome_identified(r, x): Reports the result x of identify_run(), except to the client.  Counts one
 * without a match towards the token's limit. */
void outcome_identified(struct request *r, const struct identification *x);

/* outcome_enrolled(r, out, each, n, st, e): Reports the result of enrolment_add().  Responds if st is an
 * error. */
void outcome_enrolled(struct request *r, const struct enrolment_outcome *out,
                      const struct enrolment_result *each, size_t n, enum status st,
                      const struct errinfo *e);

#endif
