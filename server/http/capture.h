/* capture.h -- signed captures: a scanner signs its scan, the target of the request and the result of its
 * liveness check by its own key (store.h).  So neither the client nor its token can replace the scan.
 *
 *   Capture-Signature: device=NAME; nonce=NONCE; liveness=pass|fail|none; sig=BASE64
 *
 * sig is the Ed25519 signature of eight lines, each with its line feed (docs/operation.md has an example):
 *   surfaced capture 2
 *   POST TARGET     the request's method and target as sent, with the query
 *   NAME
 *   NONCE           nonce of POST /v1/challenge
 *   pass            or fail, none
 *   HEX             SHA-256 of the body as sent: compressed, if it is, but not in chunks
 *   TYPE            value of Content-Type, by which the body is read; "" without it
 *   CODING          value of Content-Encoding; "" without it
 */
#ifndef SERVER_CAPTURE_H
#define SERVER_CAPTURE_H
#include <stdbool.h>
#include "store.h"

struct request;
struct worker;

/* capture_take(r, value): Copies the header's value to r->capture. */
void capture_take(struct request *r, const char *value);

/* capture_digest(r): If r has the header, sets r->capture.body to the digest of r->body.  On a worker. */
void capture_digest(struct request *r);

/* capture_admit(r): Returns true if the signature is valid, and then its nonce is used up; or if there is no
 * header and none is required.  Otherwise sets r->response. */
bool capture_admit(struct request *r);

#define CAPTURE_OUTCOME (STORE_NAME_MAX + 1)

/* capture_outcome(r, outcome, out): Writes the outcome for an event, followed by liveness and device if r's
 * capture is signed: "match capture=pass:door-1".  Returns out. */
const char *capture_outcome(const struct request *r, const char *outcome,
                            char out[CAPTURE_OUTCOME]);

/* capture_challenge(r, w): POST /v1/challenge. */
void capture_challenge(struct request *r, struct worker *w);

#endif
