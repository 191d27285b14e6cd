/* body.h -- which bodies a route takes, and unpacking them. */
#ifndef SERVER_BODY_H
#define SERVER_BODY_H
#include <stdbool.h>
#include <stdint.h>

struct request;

#define BODY_LENGTH_UNKNOWN UINT64_MAX /* it comes in chunks */

/* body_check(r, has_length, length): set r->response where r->route does not take a body of
 * which the headers say this: its length, media type and coding.  has_length: they give one,
 * or announce chunks. */
void body_check(struct request *r, bool has_length, uint64_t length);

/* body_refuse_size(r): the response to a body over the limit. */
void body_refuse_size(struct request *r);

/* body_unpack(r): unpack r->body, if it is compressed, within the limit for bodies.  On a
 * worker: it computes.  False: r->response is set: damaged, too large, empty. */
bool body_unpack(struct request *r);

#endif
