/* capture.h -- signed captures: what a scanner has captured, for what, and what its liveness
 * check said, signed by the scanner's own key (store.h), so that neither a client nor its
 * token can put another scan in the place of what a scanner saw.
 *
 *   Capture-Signature: device=NAME; nonce=NONCE; liveness=pass|fail|none; sig=BASE64
 *
 * sig is Ed25519's of eight lines, each with its line feed (docs/operation.md has an example):
 *   surfaced capture 2
 *   POST TARGET     the request's method and target as they were sent, with the query
 *   NAME
 *   NONCE           of POST /v1/challenge
 *   pass            or fail, none
 *   HEX             SHA-256 of the body as it was sent: compressed, if it is, but not in chunks
 *   TYPE            the value of Content-Type, by which the body is read; "" without it
 *   CODING          the value of Content-Encoding, likewise
 */
#ifndef SERVER_CAPTURE_H
#define SERVER_CAPTURE_H
#include <stdbool.h>
#include "store.h"

struct request;
struct worker;

/* capture_take(r, value): the header's value.
 * capture_digest(r): where there is one, r->capture.body is r->body's.  On a worker. */
void capture_take(struct request *r, const char *value);
void capture_digest(struct request *r);

/* capture_admit(r): true: the header is right and its nonce is used by now, or there is none
 * and none is required.  False: r->response says why not. */
bool capture_admit(struct request *r);

#define CAPTURE_OUTCOME (STORE_NAME_MAX + 1)

/* capture_outcome(r, outcome, out): what an event says of r: the outcome, and behind it device and
 * liveness where r's capture is signed: "match capture=pass:door-1".  Returns out. */
const char *capture_outcome(const struct request *r, const char *outcome,
                            char out[CAPTURE_OUTCOME]);

void capture_challenge(struct request *r, struct worker *w); /* POST /v1/challenge */

#endif
