/* row_crypt.h -- what a database's rows hold of a subject and a template: encrypted bytes, which
 * without the keys can be neither read nor changed, exchanged or moved (vault.h).  The row's
 * plain columns are authenticated with them.  Layout: db/FORMAT.md. */
#ifndef DB_ROW_CRYPT_H
#define DB_ROW_CRYPT_H
#include <stdbool.h>
#include <stddef.h>
#include "store_types.h"
#include "vault.h"

#define ROW_CRYPT_UID   STORE_UID
#define ROW_CRYPT_REF   16   /* a subject, in the events */
#define ROW_CRYPT_ABOUT 1024 /* bytes that suffice for any description */

struct row_crypt_key { /* of a subject */
    unsigned char uid[ROW_CRYPT_UID];
    unsigned char key[VAULT_KEY];
};

/* A subject's row is found by lookup, and named in the events by ref. */
void row_crypt_lookup(const struct vault *v, const char *subject,
                      unsigned char out[VAULT_HASH]);
void row_crypt_ref(const struct vault *v, const char *subject,
                   unsigned char out[ROW_CRYPT_REF]);

/* row_crypt_same(v, uid, digest, out): what a template of this subject and digest is found
 * by, when the same cloud comes again. */
void row_crypt_same(const struct vault *v, const unsigned char uid[ROW_CRYPT_UID],
                    const char *digest, unsigned char out[VAULT_HASH]);

/* row_crypt_cloud(v, uid, digest, out): what a scan of the subject is found by, by the digest of
 * its points as they were read, 64 hexadecimal digits. */
void row_crypt_cloud(const struct vault *v, const unsigned char uid[ROW_CRYPT_UID],
                     const char *digest, unsigned char out[VAULT_HASH]);

/* row_crypt_new(v, uid, k, wrapped): a subject's key, and where uid is NULL that too.
 * row_crypt_key(v, uid, wrapped, k): the key of a row; false: damaged, or another's. */
void row_crypt_new(const struct vault *v, const unsigned char *uid,
                   struct row_crypt_key *k, unsigned char wrapped[VAULT_WRAPPED]);
bool row_crypt_key(const struct vault *v, const unsigned char uid[ROW_CRYPT_UID],
                   const unsigned char wrapped[VAULT_WRAPPED], struct row_crypt_key *k);

/* row_crypt_encrypt_subject(k, s, out): id, reference and purpose; authenticated with
 * them: created, expires, hold and disabled.  Returns the bytes written.
 * row_crypt_decrypt_subject(k, in, n, s): the former into *s, which holds the latter. */
size_t row_crypt_encrypt_subject(const struct row_crypt_key *k,
                                 const struct store_subject *s,
                                 unsigned char out[ROW_CRYPT_ABOUT]);
bool row_crypt_decrypt_subject(const struct row_crypt_key *k, const void *in, size_t n,
                               struct store_subject *s);

/* row_crypt_encrypt_template(k, t, out): label, digest, quality and how it was enrolled; authenticated with
 * them: id, created, engine, points and triangles.  Returns the bytes written.
 * row_crypt_decrypt_template(k, in, n, t): the former into *t, which holds the latter. */
size_t row_crypt_encrypt_template(const struct row_crypt_key *k,
                                  const struct store_template *t,
                                  unsigned char out[ROW_CRYPT_ABOUT]);
bool row_crypt_decrypt_template(const struct row_crypt_key *k, const void *in, size_t n,
                                struct store_template *t);

/* The template's model, n bytes, authenticated with the same and the digest: n +
 * VAULT_OVER bytes to out; and back, n - VAULT_OVER. */
void row_crypt_encrypt_model(const struct row_crypt_key *k,
                             const struct store_template *t, const void *in, size_t n,
                             unsigned char *out);
bool row_crypt_decrypt_model(const struct row_crypt_key *k,
                             const struct store_template *t, const void *in, size_t n,
                             unsigned char *out);

#endif
