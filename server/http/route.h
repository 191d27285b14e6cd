/* route.h -- what a route is, and finding that of a request.  The table is in routes.c. */
#ifndef SERVER_ROUTE_H
#define SERVER_ROUTE_H
#include <stdbool.h>
#include <stddef.h>
#include "request.h"

struct worker; /* worker.h */

enum route_body {
    ROUTE_NO_BODY,
    ROUTE_CLOUD,  /* JSON or a scanner's file */
    ROUTE_CLOUDS, /* the same; of a form also several files, and one is as several */
    ROUTE_FRAMES, /* the same as ROUTE_CLOUD; of a form also several files */
    ROUTE_PAIR,   /* JSON, or a form with the files a and b */
    ROUTE_JSON,   /* JSON alone */
    ROUTE_MERGE   /* a JSON merge patch, or JSON */
};

enum route_where { /* handle() is called */
                   ROUTE_QUICK, /* on the I/O thread with NULL: neither computes nor touches the store */
                   ROUTE_WORKER, /* on worker w */
                   ROUTE_SLOW /* likewise, one that only such routes have: takes seconds, and is
                                 refused while another one does */
};

struct route {
    enum request_method method;
    const char *pattern; /* "/v1/subjects/{subject}/verify" */
    enum route_body body;
    /* a token must have one of these (enum store_scope); 0: none is needed */
    unsigned scope;
    const char *query; /* the query parameters it has: "units, detail"; "": none */
    void (*handle)(struct request *r, struct worker *w); /* sets r->response */
    enum route_where where;
};

/* In a scope: who sends no token is told less instead. */
#define ROUTE_OR_LESS (1U << 31)

/* route_open(route): is route for those without a token as well? */
bool route_open(const struct route *route);

/* route_find(table, n, r): set r->route by r->target and r->method, or r->response: no such
 * path, no such method, or what OPTIONS asks for. */
void route_find(const struct route *table, size_t n, struct request *r);

/* route_read_id(r): set r->subject, r->template_id or r->token_id where r->route has one, or r->response
 * when it is malformed. */
void route_read_id(struct request *r);

/* route_check_query(r): set r->response where r->target has a query parameter that r->route
 * does not, or one twice: one that is misspelt must not be ignored.  O(length of the query). */
void route_check_query(struct request *r);

/* For the log and the metrics: "GET" (of a GET or HEAD), and the pattern; of NULL (no route)
 * "-" and "none". */
const char *route_method(const struct route *route);
const char *route_pattern(const struct route *route);

#endif
