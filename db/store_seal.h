/* store_seal.h -- what a database's rows hold of a subject and a template: bytes that only
 * who has the keys can read, and nobody else can change, exchange or move (vault.h).  All
 * that stands open in the row beside them is part of what is proved.  Layout: db/FORMAT.md. */
#ifndef DB_STORE_SEAL_H
#define DB_STORE_SEAL_H
#include <stdbool.h>
#include <stddef.h>
#include "store_types.h"
#include "vault.h"

#define STORE_SEAL_UID   STORE_UID
#define STORE_SEAL_REF   16   /* a subject, in the events */
#define STORE_SEAL_ABOUT 1024 /* bytes that suffice for any description */

struct store_seal_key { /* of a subject */
    unsigned char uid[STORE_SEAL_UID];
    unsigned char key[VAULT_KEY];
};

/* A subject's row is found by lookup, and named in the events by ref. */
void store_seal_lookup(const struct vault *v, const char *subject,
                       unsigned char out[VAULT_HASH]);
void store_seal_ref(const struct vault *v, const char *subject,
                    unsigned char out[STORE_SEAL_REF]);

/* store_seal_same(v, uid, digest, out): what a template of this subject and digest is found
 * by, when the same cloud comes again. */
void store_seal_same(const struct vault *v, const unsigned char uid[STORE_SEAL_UID],
                     const char *digest, unsigned char out[VAULT_HASH]);

/* store_seal_new(v, uid, k, wrapped): a subject's key, and where uid is NULL that too.
 * store_seal_key(v, uid, wrapped, k): the key of a row; false: damaged, or another's. */
void store_seal_new(const struct vault *v, const unsigned char *uid,
                    struct store_seal_key *k, unsigned char wrapped[VAULT_WRAPPED]);
bool store_seal_key(const struct vault *v, const unsigned char uid[STORE_SEAL_UID],
                    const unsigned char wrapped[VAULT_WRAPPED], struct store_seal_key *k);

/* store_seal_subject(k, s, out): id, reference and purpose; proved with them: created,
 * expires, hold and disabled.  Returns the bytes written.
 * store_seal_open_subject(k, in, n, s): the former into *s, which holds the latter. */
size_t store_seal_subject(const struct store_seal_key *k, const struct store_subject *s,
                          unsigned char out[STORE_SEAL_ABOUT]);
bool store_seal_open_subject(const struct store_seal_key *k, const void *in, size_t n,
                             struct store_subject *s);

/* store_seal_template(k, t, out): label, digest and quality; proved with them: id, created,
 * engine, points and triangles.  Returns the bytes written.
 * store_seal_open_template(k, in, n, t): the former into *t, which holds the latter. */
size_t store_seal_template(const struct store_seal_key *k, const struct store_template *t,
                           unsigned char out[STORE_SEAL_ABOUT]);
bool store_seal_open_template(const struct store_seal_key *k, const void *in, size_t n,
                              struct store_template *t);

/* The template's model, n bytes, proved with the same: n + VAULT_OVER bytes to out; and
 * back, n - VAULT_OVER. */
void store_seal_model(const struct store_seal_key *k, const struct store_template *t,
                      const void *in, size_t n, unsigned char *out);
bool store_seal_open_model(const struct store_seal_key *k, const struct store_template *t,
                           const void *in, size_t n, unsigned char *out);

#endif
