/* store_receipt.h -- what an erasure's receipt (store_types.h) is signed by, and whether it is
 * true.  Layout: db/FORMAT.md. */
#ifndef DB_STORE_RECEIPT_H
#define DB_STORE_RECEIPT_H
#include <stdbool.h>
#include "status.h"

struct store_receipt; /* store_types.h */
struct vault;         /* vault.h */

/* store_receipt_sign(v, r): digest, public_key and signature of all else in *r, whose
 * strings are as store.h says.
 * store_receipt_true(r): do digest and signature fit, by *r's own public_key? */
void store_receipt_sign(const struct vault *v, struct store_receipt *r);
bool store_receipt_true(const struct store_receipt *r);

void store_receipt_free(struct store_receipt *r); /* what it points to, not *r */

#endif
