/* upload.h -- the body of a request while it is received: it grows with what comes, not with what
 * is announced, within the limit of a body and what its sender may have the daemon hold
 * (quota.h).  On the I/O thread only. */
#ifndef SERVER_UPLOAD_H
#define SERVER_UPLOAD_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "quota.h"
#include "status.h"

struct request;

#define UPLOAD_LENGTH_UNKNOWN UINT64_MAX /* it comes in chunks */

struct upload {
    struct request *r;        /* r->body and r->len are what has come */
    struct quota_share share; /* of r->body, later of the response */
    uint64_t length;          /* as announced, or UPLOAD_LENGTH_UNKNOWN */
    size_t cap;               /* of r->body */
};

/* upload_begin(u, r, q): nothing has come. */
void upload_begin(struct upload *u, struct request *r, struct quota *q);

/* upload_is_large(u): it is announced or has become longer than QUOTA_SMALL, or asks for a
 * response that may be. */
bool upload_is_large(const struct upload *u);

/* upload_has_room(u): there would be room now for all that is announced; before upload_add(). */
bool upload_has_room(struct upload *u);

/* upload_add(u, data, n): n more bytes.  Returns ST_OK; ST_ESIZE: longer than a body may be;
 * ST_EBUSY: there is no room for it now. */
enum status upload_add(struct upload *u, const char *data, size_t n);

/* upload_respond(u): r->response is there: the body is released, and a large response counts in
 * its place until upload_end(), but for a page, of which there is one for all. */
void upload_respond(struct upload *u);
void upload_end(struct upload *u);

#endif
