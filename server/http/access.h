/* access.h -- the record of requests: a line of the log, and entries of the audit log. */
#ifndef SERVER_ACCESS_H
#define SERVER_ACCESS_H

struct request;

/* access_log(r, http, ms): Logs a request that has ended: its id, route, status and times, the id of its token,
 * and the cause of a 5xx.  Logs no subject.  At most once a minute, logs the number of requests that were refused
 * because of overload.  On the I/O thread.
 *   http, ms  as in metrics_request() */
void access_log(const struct request *r, int http, double ms);

/* access_event(r, kind, outcome): Appends an entry about r's subject and template to the audit log.  If that
 * fails, logs it; the response stands. */
void access_event(struct request *r, const char *kind, const char *outcome);

/* Refusals of a token that are entered in the audit log, a minute: a door has a few, and they are cheaper than a
 * verification. */
#define ACCESS_REFUSALS 120

/* access_refusal(r): Appends an entry "refused" if r is a verification, an identification or an enrolment that was
 * refused with a 4xx, unless the cause has an entry already.  Counts a scan that could not be verified or
 * identified as unusable. */
void access_refusal(struct request *r);

#endif
