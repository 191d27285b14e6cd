/* access.h -- what is recorded of requests: a line of the log, entries of the audit log. */
#ifndef SERVER_ACCESS_H
#define SERVER_ACCESS_H

struct request;

/* access_log(r, http, ms): its id, route, status and times, the token's id, and the fault
 * behind a 5xx; no subject; and a warning a minute of requests that were refused for overload.
 * http, ms: as for metrics_request().  On the I/O thread. */
void access_log(const struct request *r, int http, double ms);

/* access_event(r, kind, outcome): an entry of the audit log that r's response does not wait for, of
 * its subject and template; where it is lost, the response stands. */
void access_event(struct request *r, const char *kind, const char *outcome);

#endif
