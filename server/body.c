#include "body.h"

#include <stdlib.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "inflate.h"
#include "request.h"
#include "route.h"

/* NULL, or the values of Content-Type of which the route wants one. */
static const char *wants(const struct request *r)
{
    switch (r->route->body) {
    case ROUTE_CLOUD:
        return r->media == REQUEST_JSON || r->media == REQUEST_SCAN
                   ? NULL
                   : cloudformat_media_list();
    case ROUTE_JSON:
        return r->media == REQUEST_JSON ? NULL : "application/json";
    case ROUTE_MERGE:
        return r->media == REQUEST_MERGE || r->media == REQUEST_JSON
                   ? NULL
                   : "application/merge-patch+json or application/json";
    case ROUTE_NO_BODY:
        break;
    }
    return NULL;
}

static void refuse_coding(struct request *r)
{
    request_problem(r, ERRMAP_CODING,
                    "Content-Encoding may be gzip or zstd, one of them and once");
    r->response.codings = true;
}

void body_refuse_size(struct request *r)
{
    request_problem(r, ERRMAP_BODY_SIZE, "the limit is %zu bytes", r->app->max_body);
}

void body_check(struct request *r, bool has_length, uint64_t length)
{
    const char *types = wants(r);

    if (length != BODY_LENGTH_UNKNOWN && length > r->app->max_body)
        body_refuse_size(r);
    else if (r->route->body == ROUTE_NO_BODY)
        return;
    else if (!has_length)
        request_problem(r, ERRMAP_NO_LENGTH,
                        "send Content-Length, or the body in chunks");
    else if (r->coding == INFLATE_OTHER)
        refuse_coding(r);
    else if (types != NULL)
        request_problem(r, ERRMAP_MEDIA_TYPE, "Content-Type must be %s", types);
    else if (length == 0)
        request_problem(r, ST_EINVAL, "the body is empty");
}

bool body_unpack(struct request *r)
{
    struct errinfo e = {0};
    unsigned char *body;
    size_t len;
    enum status st;

    if (r->coding == INFLATE_NONE || r->len == 0)
        return true;
    st = inflate_body(r->coding, r->body, r->len, r->app->max_body, &body, &len, &e);
    free(r->body); /* its bytes stay counted in http.c until the request ends */
    r->body = body;
    r->len = len;
    r->coding = INFLATE_NONE;
    if (st == ST_OK && len > 0)
        return true;
    if (st == ST_OK)
        request_problem(r, ST_EINVAL, "the body is empty");
    else
        request_problem(r,
                        st == ST_EINVAL   ? (unsigned)ERRMAP_PACKED
                        : st == ST_ELIMIT ? (unsigned)ERRMAP_BODY_SIZE
                                          : (unsigned)st,
                        "%s", e.msg);
    return false;
}
