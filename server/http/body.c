#include "body.h"

#include <string.h>

#include "app.h"
#include "cloudfile.h"
#include "errinfo.h"
#include "errmap.h"
#include "inflate.h"
#include "mem.h"
#include "request.h"
#include "route.h"
#include "upload.h"

/* NULL, or the values of Content-Type of which the route wants one. */
static const char *wants(const struct request *r)
{
    switch (r->route->body) {
    case ROUTE_CLOUD:
    case ROUTE_CLOUDS:
    case ROUTE_FRAMES:
        return r->media == REQUEST_OTHER_MEDIA || r->media == REQUEST_MERGE
                   ? cloudformat_media_list()
                   : NULL;
    case ROUTE_PAIR:
        return r->media == REQUEST_JSON || r->media == REQUEST_FORM
                   ? NULL
                   : "application/json, or multipart/form-data with the files a and b";
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
    request_problem(r, ST_ESIZE, "the limit is %zu bytes", r->app->max_body);
}

void body_refuse_room(struct request *r)
{
    request_problem(r, ERRMAP_OVERLOAD, "no room for the body now");
}

/* A client that sends one means something by it: it must not be ignored. */
void body_refuse_any(struct request *r)
{
    request_problem(r, ST_EINVAL, "this method of this path takes no body");
}

void body_check(struct request *r, bool has_length, uint64_t length)
{
    const char *types = wants(r);

    if (r->route->body == ROUTE_NO_BODY) { /* first: a stranger is not told the limit */
        if (length != UPLOAD_LENGTH_UNKNOWN && length > 0)
            body_refuse_any(r);
        return;
    }
    if (length != UPLOAD_LENGTH_UNKNOWN && length > r->app->max_body)
        body_refuse_size(r);
    else if (!has_length)
        request_problem(r, ERRMAP_NO_LENGTH,
                        "send Content-Length, or the body in chunks");
    else if (r->coding == INFLATE_OTHER)
        refuse_coding(r);
    else if (types != NULL)
        request_problem(r, ERRMAP_MEDIA_TYPE, "Content-Type must be %s%s", types,
                        r->route->body == ROUTE_CLOUD
                            ? ", or multipart/form-data with one file"
                        : r->route->body == ROUTE_CLOUDS || r->route->body == ROUTE_FRAMES
                            ? ", or multipart/form-data with files"
                            : "");
    else if (r->media == REQUEST_FORM && r->boundary[0] == '\0')
        request_problem(r, ST_EINVAL,
                        "multipart/form-data needs a boundary of 1 to %d characters",
                        MULTIPART_BOUNDARY_MAX);
    else if (length == 0)
        request_problem(r, ST_EINVAL, "the body is empty");
}

static bool decompress(struct request *r)
{
    const size_t most =
        r->large || r->app->max_body < QUOTA_SMALL ? r->app->max_body : QUOTA_SMALL;
    struct errinfo e = {0};
    unsigned char *body;
    size_t len;
    enum status st;

    if (r->coding == INFLATE_NONE || r->len == 0)
        return true;
    st = inflate_body(r->coding, r->body, r->len, most, &body, &len, &e);
    if (st == ST_ESIZE && !r->large) {
        r->large = true;
        return false;
    }
    mem_free(r->body); /* its bytes stay counted until there is a response */
    r->body = body;
    r->len = len;
    r->coding = INFLATE_NONE;
    if (st == ST_OK && len > 0)
        return true;
    if (st == ST_OK)
        request_problem(r, ST_EINVAL, "the body is empty");
    else
        request_problem(r, st == ST_EINVAL ? (unsigned)ERRMAP_PACKED : (unsigned)st, "%s",
                        e.msg);
    return false;
}

/* The one file of a form, as if it alone were the body.  Its media type is whatever the system of a
 * browser has for the ending of the name: one that is none of a scan says nothing.  Several stay as
 * they are. */
static bool take_files(struct request *r)
{
    struct multipart_file f[MULTIPART_FILES_MAX];
    struct errinfo e = {0};
    size_t n;

    if (r->route->body == ROUTE_CLOUDS)
        return true;
    if (multipart_read(r->body, r->len, r->boundary,
                       r->route->body == ROUTE_FRAMES ? MULTIPART_FRAMES_MAX : 1, f, &n,
                       &e) != ST_OK) {
        request_fail(r, &e);
        return false;
    }
    if (n > 1)
        return true;
    r->coding = inflate_coding(f->coding[0] != '\0' ? f->coding : NULL);
    r->media = request_media(f->type, &r->format);
    if (r->media != REQUEST_JSON)
        r->media = REQUEST_SCAN;
    memmove(r->body, f->data, f->len);
    r->body[f->len] = 0;
    r->len = f->len;
    if (r->coding == INFLATE_OTHER)
        refuse_coding(r);
    else if (f->len == 0)
        request_problem(r, ST_EINVAL, "the file is empty");
    return r->response.http == 0;
}

/* format: as declared. */
static size_t weigh_scan(const struct request *r, const unsigned char *bytes, size_t len,
                         enum cloudformat format)
{
    char width[16];
    const bool raw = format == CLOUDFORMAT_ANY &&
                     request_query(r, "width", width, sizeof width) != ST_ENOTFOUND;

    return cloudfile_weight(bytes, len, raw ? CLOUDFORMAT_RAW : format);
}

/* What the body becomes, SIZE_MAX if that is not known yet. */
static size_t body_weigh(const struct request *r)
{
    struct multipart_file f[MULTIPART_FILES_MAX];
    struct errinfo e = {0};
    size_t n, sum = r->len;

    if (r->media != REQUEST_FORM)
        return weigh_scan(r, r->body, r->len, r->format);
    (void)multipart_read(r->body, r->len, r->boundary, MULTIPART_FILES_MAX, f, &n, &e);
    for (size_t i = 0; i < n; i++) {
        enum cloudformat format = CLOUDFORMAT_ANY;
        size_t one = SIZE_MAX;

        (void)request_media(f[i].type, &format);
        if (f[i].coding[0] == '\0')
            one = weigh_scan(r, f[i].data, f[i].len, format);
        sum = one < SIZE_MAX - sum ? sum + one : SIZE_MAX;
    }
    return sum;
}

bool body_unpack(struct request *r)
{
    if (!decompress(r) || (r->media == REQUEST_FORM && r->route->body != ROUTE_PAIR &&
                           !(take_files(r) && decompress(r))))
        return false;
    if (r->large || r->len == 0 || body_weigh(r) <= QUOTA_SMALL)
        return true;
    r->large = true;
    return false;
}
