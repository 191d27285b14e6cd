/* store_receipt.h -- what is left of a subject that was erased, for the person who asked for it:
 * signed, so that others can verify it.  Layout: db/FORMAT.md. */
#ifndef DB_STORE_RECEIPT_H
#define DB_STORE_RECEIPT_H
#include "rows_types.h"

struct store_receipt {
    char subject[STORE_SUBJECT_MAX + 1];
    char uid[2 * STORE_UID + 1]; /* by which the logs name the subject, in hexadecimal */
    char at[32];
    char (*template_id)[STORE_ID_LEN + 1]; /* [templates], oldest first */
    uint32_t templates;
    char digest[65]; /* SHA-256 of all of the above */
    uint64_t seq;    /* of its entry in the change log, and that one's hash */
    char hash[65];
    char signature[129]; /* Ed25519 of digest, seq and hash */
    char public_key[65]; /* that it is verified with */
};

/* store_receipt_sign(c, r): digest, public_key and signature of all else in *r, whose
 * strings are as store.h says.
 * store_receipt_true(r): do digest and signature fit, by *r's own public_key? */
void store_receipt_sign(const struct crypt *c, struct store_receipt *r);
bool store_receipt_true(const struct store_receipt *r);

void store_receipt_free(struct store_receipt *r); /* what it points to, not *r */

#endif
