/* access.h -- the access log: a line for each request. */
#ifndef SERVER_ACCESS_H
#define SERVER_ACCESS_H

struct request;

/* access_log(r, http, ms): its id, route, status and times, the token's id, and the fault
 * behind a 5xx; no subject; and a warning a minute of requests that were refused for overload.
 * http, ms: as for metrics_request().  On the I/O thread. */
void access_log(const struct request *r, int http, double ms);

#endif
