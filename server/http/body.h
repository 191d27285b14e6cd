/* body.h -- checks whether a route accepts a body, decompresses it, and takes the file out of a
 * form. */
#ifndef SERVER_BODY_H
#define SERVER_BODY_H
#include <stdbool.h>
#include <stdint.h>

struct request;

/* body_check(r, has_length, length): sets r->response if r->route does not accept a body of this
 * length (upload.h) and of r's media type and coding.  has_length: the headers give a length or
 * announce chunks. */
void body_check(struct request *r, bool has_length, uint64_t length);

/* body_refuse_size(r): the response to a body over the limit. */
void body_refuse_size(struct request *r);

/* body_refuse_room(r): the response to a body that there is no memory for now. */
void body_refuse_room(struct request *r);

/* body_refuse_any(r): the response to a body where r->route has none. */
void body_refuse_any(struct request *r);

/* body_unpack(r): decompresses r->body, if it is compressed, within the limit for bodies.  A body of which
 * more than QUOTA_SMALL would become, by its bytes or by the points that its header says
 * (cloudfile_weight()), needs r->large.  A form
 * (multipart.h) with one file is replaced by that file, its media type and its coding; a form with
 * several, where r->route takes them, stays as it is, with REQUEST_FORM in r->media.  On a worker,
 * since it computes.  False: the body is damaged, too large or empty, and r->response is set; or
 * r->large was not set and is now, and r->response is not: queue r again, and call this again. */
bool body_unpack(struct request *r);

#endif
