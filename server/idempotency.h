/* idempotency.h -- a request that is sent again, because its answer was lost, gets that
 * answer and is not done twice (draft-ietf-httpapi-idempotency-key-header).
 * Known by the client's key and its token; held for IDEMPOTENCY_HOURS, or until as many
 * newer ones have come as there is room for.  In memory alone: what is enrolled is known by
 * its content anyway (store.h), so that after a restart the worst that a retry gets is 200
 * where it had been 201.  Keys are kept as keyed hashes.  Safe on any thread. */
#ifndef SERVER_IDEMPOTENCY_H
#define SERVER_IDEMPOTENCY_H
#include <stdbool.h>
#include <stdint.h>

struct idempotency;
struct request;

#define IDEMPOTENCY_HOURS 24
#define IDEMPOTENCY_ROOM  8192 /* keys; with answers of 1 KB about 10 MB */

/* idempotency_new(room): for so many keys, 1 <= room <= 2^20.  NULL: out of memory. */
struct idempotency *idempotency_new(uint32_t room);
void idempotency_free(struct idempotency *m); /* NULL is allowed */

/* idempotency_begin(m, r, now_ms, ticket): true: do r, then call idempotency_end() with the
 * ticket.  False: r->response is set: what it was the first time; 409, the first is being
 * done; 422, the key was used for another request; 400, the key is malformed.
 * The same request: method, path with its query, media type, and body (unpacked). */
bool idempotency_begin(struct idempotency *m, struct request *r, double now_ms,
                       uint32_t *ticket);

/* idempotency_end(m, r, ticket): r->response is there.  A 5xx is not kept: to be tried again. */
void idempotency_end(struct idempotency *m, const struct request *r, uint32_t ticket);

/* idempotency_erase(m, subject): keep nothing of the subject but that the key was used: an
 * answer of success loses its body, any other is forgotten. */
void idempotency_erase(struct idempotency *m, const char *subject);

#endif
