/* idempotency.h -- a request that is repeated because its response was lost gets that response
 * and takes effect once (draft-ietf-httpapi-idempotency-key-header).
 * Requests are identified by the client's key and token, and kept for IDEMPOTENCY_HOURS, those of
 * a signed capture for as long as a nonce (store_capture.h): who recorded one shall not have its
 * decision again all day; or until newer ones need the room.
 * In memory alone, and of this process: the store recognises a
 * template by its content anyway (store.h), so that after a restart a retry gets 200 instead of
 * 201 at worst; a verification is done again then, once where probes are kept (row_cloud.h), and is
 * one more event.
 * Keys are kept as keyed hashes.  Safe on any thread. */
#ifndef SERVER_IDEMPOTENCY_H
#define SERVER_IDEMPOTENCY_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "store_types.h"

struct idempotency;
struct request;

#define IDEMPOTENCY_HOURS 24
#define IDEMPOTENCY_ROOM  8192               /* keys */
#define IDEMPOTENCY_BYTES ((size_t)32 << 20) /* of responses; the oldest go first */

/* idempotency_new(room): for so many keys, 1 <= room <= 2^20.  NULL: out of memory. */
struct idempotency *idempotency_new(uint32_t room);
void idempotency_free(struct idempotency *m); /* NULL is allowed */

/* idempotency_begin(m, r, now_ms, ticket): true: do r, then call idempotency_end() with the
 * ticket.  False: r->response is set: that of the first time; 409, the first is not
 * finished; 422, the key was used for another request; 400, the key is malformed.
 * The same request: method, path with its query, media type, signed capture, and body
 * (unpacked). */
bool idempotency_begin(struct idempotency *m, struct request *r, double now_ms,
                       uint32_t *ticket);

/* idempotency_end(m, r, subject, ticket): r->response is there, about this subject.  A 429 or 5xx
 * is not kept, nor a capture that was refused: to be tried again; nor one of more than
 * IDEMPOTENCY_BYTES / 8. */
void idempotency_end(struct idempotency *m, const struct request *r, const char *subject,
                     uint32_t ticket);

/* idempotency_erase(m, subject): keeps nothing of the subject but that the key was used: a
 * successful response loses its body, any other is forgotten, one that is under way is not kept.
 * idempotency_empty(m, r): the same of the response that idempotency_begin() gave r. */
void idempotency_erase(struct idempotency *m, const char *subject);
void idempotency_empty(struct idempotency *m, const struct request *r);

/* idempotency_name(r, hex): 64 hexadecimal digits for r's key and token, the same in each process;
 * "": it has no key. */
void idempotency_name(const struct request *r, char hex[65]);

/* idempotency_list(m, n): the subjects of which it keeps a response, as cache_list(). */
char (*idempotency_list(struct idempotency *m, size_t *n))[STORE_SUBJECT_MAX + 1];

#endif
