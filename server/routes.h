/* routes.h -- which paths there are, which methods they have, and who answers. */
#ifndef SERVER_ROUTES_H
#define SERVER_ROUTES_H
#include <stdbool.h>
#include <stddef.h>
#include "request.h"

struct worker; /* queue.h */

enum routes_body {
    ROUTES_NO_BODY,
    ROUTES_CLOUD, /* JSON or a scanner's file */
    ROUTES_JSON,  /* JSON alone */
    ROUTES_MERGE  /* a JSON merge patch, or JSON */
};

struct routes_route {
    enum request_method method;
    const char *pattern; /* "/v1/subjects/{subject}/verify" */
    enum routes_body body;
    unsigned scope;    /* a token must have (enum store_scope); 0: none is asked for */
    const char *query; /* the query parameters it has: "units, detail"; "": none */
    /* handle(r, w): set r->answer.  Called on worker w; or, if w is not wanted (quick), on
     * the I/O thread with NULL: then it neither computes nor touches the store. */
    void (*handle)(struct request *r, struct worker *w);
    bool quick;
};

#define ROUTES_MAX 32 /* routes_index() stays below */

/* routes_find(r): set r->route by r->target and r->method, or r->answer: no such path, no
 * such method. */
void routes_find(struct request *r);

/* routes_wants(r): NULL, or the values of Content-Type of which r->route wants one, where
 * r->media is another. */
const char *routes_wants(const struct request *r);

/* routes_read_id(r): set r->subject or r->template_id where the route has one, or r->answer
 * when it is malformed. */
void routes_read_id(struct request *r);

/* routes_check_query(r): set r->answer where r->target has a query parameter that r->route
 * does not: one that is misspelt must not be ignored.  O(length of the query). */
void routes_check_query(struct request *r);

/* routes_index(route): a small number for each route, 0 for NULL ("no route"). */
size_t routes_index(const struct routes_route *route);

/* routes_name(index): the pattern, "none" for 0, NULL behind the last; *method: "GET". */
const char *routes_name(size_t index, const char **method);

#endif
