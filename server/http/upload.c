#include "upload.h"

#include <string.h>

#include "app.h"
#include "mem.h"
#include "request.h"
#include "route.h"

#define FIRST_ROOM ((size_t)64 << 10)
/* Responses up to this are not counted: they go into the socket's buffer at once. */
#define SMALL_RESPONSE ((size_t)64 << 10)

void upload_begin(struct upload *u, struct request *r, struct quota *q)
{
    *u = (struct upload){.r = r, .share = {.q = q}};
}

/* The heat map of 46 KB of a compressed scan has 6 MB. */
static bool asks_for_much(const struct request *r)
{
    char detail[16];

    return request_query(r, "detail", detail, sizeof detail) == ST_OK &&
           strcmp(detail, "heatmap") == 0;
}

bool upload_is_large(const struct upload *u)
{
    return u->cap > QUOTA_SMALL || asks_for_much(u->r) ||
           (u->length != UPLOAD_LENGTH_UNKNOWN && u->length >= QUOTA_SMALL);
}

bool upload_has_room(struct upload *u)
{
    u->share.sender = request_sender(u->r); /* its token is known by now */
    return u->length == UPLOAD_LENGTH_UNKNOWN ||
           quota_fits(&u->share, upload_is_large(u) ? QUOTA_IS_LARGE : QUOTA_IS_SMALL,
                      (size_t)u->length + 1);
}

/* Room for n more bytes and a final 0. */
static bool make_room(struct upload *u, size_t n)
{
    const size_t need = u->r->len + n + 1, most = u->r->app->max_body + 1;
    size_t cap = u->cap;
    unsigned char *body;

    if (need <= cap)
        return true;
    if (cap == 0 && u->length < QUOTA_SMALL)
        cap = (size_t)u->length + 1; /* the announced length: it costs little */
    while (cap <
           need) /* moving a large body costs nothing, and unused memory must be wiped */
        cap = cap < FIRST_ROOM ? FIRST_ROOM : cap < QUOTA_SMALL ? 2 * cap : cap + cap / 8;
    if (cap > most)
        cap = most;
    if (!quota_hold(&u->share,
                    cap > QUOTA_SMALL || upload_is_large(u) ? QUOTA_IS_LARGE
                                                            : QUOTA_IS_SMALL,
                    cap))
        return false;
    if ((body = mem_grow(u->r->body, u->r->len, cap)) == NULL)
        return false; /* the share is given back with the request */
    u->r->body = body;
    u->cap = cap;
    return true;
}

enum status upload_add(struct upload *u, const char *data, size_t n)
{
    struct request *r = u->r;

    if (n > r->app->max_body - r->len)
        return ST_ESIZE;
    if (r->route->body == ROUTE_NO_BODY) {
        r->len += n; /* counted against the limit, and not kept */
        return ST_OK;
    }
    if (!make_room(u, n))
        return ST_EBUSY;
    memcpy(r->body + r->len, data, n);
    r->len += n;
    r->body[r->len] = 0;
    return ST_OK;
}

void upload_respond(struct upload *u)
{
    const size_t len = u->r->response.page != NULL || u->r->response.file != NULL
                           ? 0
                           : u->r->response.len;

    mem_free(u->r->body);
    u->r->body = NULL;
    u->cap = 0;
    if (u->share.bytes == 0)
        u->share.sender = request_sender(u->r);
    (void)quota_owe(&u->share, QUOTA_IS_LARGE, len > SMALL_RESPONSE ? len : 0);
}

void upload_end(struct upload *u)
{
    if (u->share.q != NULL)
        (void)quota_owe(&u->share, QUOTA_IS_SMALL, 0);
}
