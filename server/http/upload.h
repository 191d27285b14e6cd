/* upload.h -- the body of a request while it is received.  It grows with the bytes that have come, not with the
 * announced length, within the limit of a body and the quota of its sender (quota.h).  On the I/O thread
 * only. */
#ifndef SERVER_UPLOAD_H
#define SERVER_UPLOAD_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "quota.h"
#include "status.h"

struct request;

#define UPLOAD_LENGTH_UNKNOWN UINT64_MAX /* the body comes in chunks */

struct upload {
    struct request *r;        /* r->body and r->len are the bytes that have come */
    struct quota_share share; /* bytes held by r->body, later by the response */
    uint64_t length;          /* announced length, or UPLOAD_LENGTH_UNKNOWN */
    size_t cap;               /* allocated bytes of r->body */
};

/* upload_begin(u, r, q): Prepares u; no byte has come. */
void upload_begin(struct upload *u, struct request *r, struct quota *q);

/* upload_is_large(u): Returns true if the body is announced or has become longer than QUOTA_SMALL, or if the
 * response may. */
bool upload_is_large(const struct upload *u);

/* upload_has_room(u): Returns true if there is room now for the announced length.  Before upload_add(). */
bool upload_has_room(struct upload *u);

/* upload_add(u, data, n): Appends n bytes.  ST_OK; ST_ESIZE: the body is over the limit; ST_EBUSY: there is no
 * room for it now. */
enum status upload_add(struct upload *u, const char *data, size_t n);

/* upload_respond(u): Releases the body; r->response is set.  From now on a large response counts in its place.
 * A page does not count: there is one for all requests. */
void upload_respond(struct upload *u);

/* upload_end(u): Gives back the share of the response. */
void upload_end(struct upload *u);

#endif
