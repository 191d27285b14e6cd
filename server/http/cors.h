/* cors.h -- pages of other origins that may use the API (Fetch, "CORS protocol"): only the origins that the
 * daemon's options name, and without the browser's own credentials, because a token is none. */
#ifndef SERVER_CORS_H
#define SERVER_CORS_H
#include <stdbool.h>

struct request;
struct response;

/* cors_take(r): Sets r->response.origin if pages of r->origin may read the response.  After the headers. */
void cors_take(struct request *r);

/* cors_refuse(r): Without tokens (--no-auth): returns true if r comes from a page of another site
 * (Sec-Fetch-Site, Origin) or names another host, and then sets r->response.  A Unix socket is never refused,
 * because no browser connects to it.  After route_find() and cors_take(). */
bool cors_refuse(struct request *r);

/* cors_headers(a, add, arg): Calls add(arg, name, value) for each CORS header of the response. */
void cors_headers(const struct response *a,
                  void (*add)(void *arg, const char *name, const char *value), void *arg);

#endif
