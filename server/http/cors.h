/* cors.h -- pages of other origins that may use the API (Fetch, "CORS protocol"): those that are named
 * to the daemon, never all, and never with credentials of the browser's own, for a token is none. */
#ifndef SERVER_CORS_H
#define SERVER_CORS_H
#include <stdbool.h>

struct request;
struct response;

/* cors_take(r): after the headers: may the page of r->origin read r's response? */
void cors_take(struct request *r);

/* cors_refuse(r): without tokens (--no-auth), is r what a page of another site makes a browser on
 * this machine send (Sec-Fetch-Site, Origin), or for another host's name?  Then r->response is set.
 * After route_find() and cors_take(); not for Unix sockets, which no browser connects to. */
bool cors_refuse(struct request *r);

/* cors_headers(a, add, arg): add(arg, name, value) each header of the response. */
void cors_headers(const struct response *a,
                  void (*add)(void *arg, const char *name, const char *value), void *arg);

#endif
