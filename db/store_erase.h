/* store_erase.h -- subjects erased: the bytes are overwritten, and leave the WAL. */
#ifndef DB_STORE_ERASE_H
#define DB_STORE_ERASE_H
#include "store_open.h"

struct log_act;      /* log_entry.h */
struct log_txn;      /* log_txn.h */
struct rows_subject; /* rows_subject.h */

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

/* store_subject_erase(s, actor, subject, out, e): the subject and all its templates.  *out is
 * released by store_receipt_free(), also on failure.  ST_EHELD: it is on hold.
 * store_subject_purge(s, actor, subject, e): only if it has expired, else ST_ENOTFOUND. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);

/* store_erase_rows(t, by, of, outcome, out, e): the subject's row and its templates' are deleted,
 * with a change for each; out: NULL, or receives the templates' ids. */
enum status store_erase_rows(struct log_txn *t, const struct log_act *by,
                             const struct rows_subject *of, const char *outcome,
                             struct store_receipt *out, struct errinfo *e);

/* store_erased_since(s, since, erased, e): has any process erased a subject or a template since
 * the last call with this *since, at first 0?  What is kept of them in memory is to be
 * dropped then.  O(changes since). */
enum status store_erased_since(struct store *s, int64_t *since, bool *erased,
                               struct errinfo *e);

#endif
