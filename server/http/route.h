/* route.h -- a route, and the search for that of a request.  The table is in routes.c. */
#ifndef SERVER_ROUTE_H
#define SERVER_ROUTE_H
#include <stdbool.h>
#include <stddef.h>
#include "request.h"

struct worker; /* worker.h */

enum route_body {
    ROUTE_NO_BODY,
    ROUTE_CLOUD,  /* JSON or a scanner's file */
    ROUTE_CLOUDS, /* as ROUTE_CLOUD; a form stays one, with one file or several */
    ROUTE_FRAMES, /* as ROUTE_CLOUD; a form with several files stays one */
    ROUTE_PAIR,   /* JSON, or a form with the files a and b */
    ROUTE_JSON,   /* JSON alone */
    ROUTE_MERGE   /* a JSON merge patch, or JSON */
};

enum route_where {              /* the thread that calls handle() */
                   ROUTE_QUICK, /* the I/O thread, with NULL: neither computes nor uses the store */
                   ROUTE_WORKER, /* worker w */
                   ROUTE_SLOW /* a worker for such routes alone: takes seconds, one at a time */
};

struct route {
    enum request_method method;
    const char *pattern; /* "/v1/subjects/{subject}/verify" */
    enum route_body body;
    /* scopes of which the token needs one (enum store_scope); 0: no token is needed */
    unsigned scope;
    const char *query; /* names of the query parameters: "units, detail"; "": none */
    void (*handle)(struct request *r, struct worker *w); /* sets r->response */
    enum route_where where;
};

/* In a scope: a request without a token is served too, with a shorter response. */
#define ROUTE_OR_LESS (1U << 31)

/* route_open(route): Returns true if route serves requests without a token. */
bool route_open(const struct route *route);

/* route_find(table, n, r): Sets r->route by r->target and r->method.  If there is no such path or method, or the
 * method is OPTIONS, sets r->response. */
void route_find(const struct route *table, size_t n, struct request *r);

/* route_read_id(r): Sets r->subject, r->template_id or r->token_id if r->route has one.  If it is malformed, sets
 * r->response. */
void route_read_id(struct request *r);

/* route_check_query(r): Sets r->response if r->target has a query parameter that r->route does not have, or one
 * twice: a misspelt parameter must not be ignored. */
void route_check_query(struct request *r);

/* route_method(route): Returns the method for the log and the metrics: "GET" also for HEAD; "-" for NULL. */
const char *route_method(const struct route *route);

/* route_pattern(route): Returns the pattern for the log and the metrics; "none" for NULL. */
const char *route_pattern(const struct route *route);

#endif
