/* body.h -- checks whether a route accepts a body, decompresses it, and takes the file out of a form. */
#ifndef SERVER_BODY_H
#define SERVER_BODY_H
#include <stdbool.h>
#include <stdint.h>

struct request;

/* body_check(r, has_length, length): Sets r->response if r->route does not accept a body of this length and of
 * r's media type and coding.
 *   has_length  the headers give a length or announce chunks
 *   length      as in struct upload (upload.h) */
void body_check(struct request *r, bool has_length, uint64_t length);

/* body_refuse_size(r): Responds that the body is over the limit. */
void body_refuse_size(struct request *r);

/* body_refuse_room(r): Responds that there is no memory for the body now. */
void body_refuse_room(struct request *r);

/* body_refuse_any(r): Responds that r->route takes no body. */
void body_refuse_any(struct request *r);

/* body_unpack(r): Decompresses r->body within the limit for bodies.  Replaces a form (multipart.h) with one file
 * by that file, its media type and its coding.  Leaves a form with several files as it is, with REQUEST_FORM in
 * r->media, if r->route takes several.  A body that becomes larger than QUOTA_SMALL, by its bytes or by the points that its header
 * gives (cloudfile_weight()), needs r->large.  On a worker.
 * Returns false in two cases.  If the body is damaged, too large or empty, it has set r->response.  If
 * r->large was not set and is needed, it has set r->large: queue r again, and call this again. */
bool body_unpack(struct request *r);

#endif
