/* crypt.h -- the keys of a database, and what they encrypt.
 *
 *   master key, kept outside     wraps the root's secrets and every subject's key
 *   root: lookup, mac, signing   find a subject without storing its id; authenticate the audit log
 *   a subject's own random key   encrypts all that is known of the subject; erasing it erases
 *                                the subject, in whatever copy of the rows is left
 *
 * Encrypted with XChaCha20-Poly1305 (libsodium) under a random nonce, which stands first; the
 * associated data say which row and what in it, so that nothing can be moved or exchanged.
 * Keys lie in locked memory with guard pages and are wiped when they go.  Nothing here is
 * for printing.  Calls are safe from any number of threads: a struct crypt never changes. */
#ifndef DB_CRYPT_H
#define DB_CRYPT_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct crypt;

#define CRYPT_KEY        32                       /* bytes of any key */
#define CRYPT_OVER       40                       /* more bytes encrypted than plain */
#define CRYPT_WRAPPED    (CRYPT_KEY + CRYPT_OVER) /* an encrypted key */
#define CRYPT_HASH       32                       /* of lookups and macs */
#define CRYPT_SIGN       64                       /* a signature: Ed25519 */
#define CRYPT_SALT       16
#define CRYPT_SECRETS    (3 * CRYPT_KEY)
#define CRYPT_SECRET_MAX 1024 /* bytes of a passphrase */

/* Where the master key comes from; stored, so never renumbered. */
enum crypt_kind {
    CRYPT_PLAINTEXT = 0, /* the root itself: the database alone suffices to read it */
    CRYPT_FILE = 1,      /* 256 random bits in a file */
    CRYPT_PASSPHRASE = 2 /* by Argon2id */
};

struct crypt_root { /* what the database keeps of its keys */
    enum crypt_kind kind;
    uint32_t passes, mib;               /* of Argon2id, else 0 */
    unsigned char salt[CRYPT_SALT];     /* random, also names the master key */
    unsigned char plaintext[CRYPT_KEY]; /* CRYPT_PLAINTEXT: the master key, else 0 */
    unsigned char public[CRYPT_KEY];    /* what signatures are verified with */
    unsigned char secrets[CRYPT_SECRETS + CRYPT_OVER];
};

/* crypt_make(kind, secret, len, root, out, e): new secrets under a master key.  secret:
 * CRYPT_FILE its 32 bytes, CRYPT_PASSPHRASE 1 to CRYPT_SECRET_MAX, CRYPT_PLAINTEXT none.
 * Argon2id takes 0.3 s and 128 MB.  *out is released by crypt_free().
 * Returns ST_OK, ST_EINVAL (length), ST_ENOMEM. */
enum status crypt_make(enum crypt_kind kind, const void *secret, size_t len,
                       struct crypt_root *root, struct crypt **out, struct errinfo *e);

/* crypt_open(root, secret, len, out, e): the keys of a root that may come from anyone.
 * Returns ST_OK; ST_EDENIED: not its master key, or the root was tampered with; ST_ECORRUPT:
 * impossible; ST_EINVAL, ST_ENOMEM. */
enum status crypt_open(const struct crypt_root *root, const void *secret, size_t len,
                       struct crypt **out, struct errinfo *e);

void crypt_free(struct crypt *v); /* wiped; NULL is allowed */

/* crypt_encrypt(key, about, nabout, in, n, out): n + CRYPT_OVER bytes to out.
 * crypt_decrypt(key, about, nabout, in, n, out): n - CRYPT_OVER bytes to out; false: other
 * bytes than were encrypted, under another key or about something else, and out is undefined. */
void crypt_encrypt(const unsigned char key[CRYPT_KEY], const void *about, size_t nabout,
                   const void *in, size_t n, unsigned char *out);
_Bool crypt_decrypt(const unsigned char key[CRYPT_KEY], const void *about, size_t nabout,
                    const void *in, size_t n, unsigned char *out);

/* crypt_wrap(c, what, name, in, out): 32 bytes encrypted under the master key, bound to a label
 * and 16 bytes that name their row: a subject's key, the digest of a log's entry.
 * crypt_unwrap(): false as above. */
void crypt_wrap(const struct crypt *c, const char what[16], const unsigned char name[16],
                const unsigned char in[CRYPT_KEY], unsigned char out[CRYPT_WRAPPED]);
_Bool crypt_unwrap(const struct crypt *c, const char what[16],
                   const unsigned char name[16],
                   const unsigned char wrapped[CRYPT_WRAPPED],
                   unsigned char out[CRYPT_KEY]);

/* crypt_lookup(c, what, data, n, out): a keyed hash of n bytes to find a row by; the same
 * as long as the secrets are.  what: a word that keeps one use from another.
 * crypt_mac(c, data, n, out): a MAC of the bytes. */
void crypt_lookup(const struct crypt *c, const char *what, const void *data, size_t n,
                  unsigned char out[CRYPT_HASH]);
void crypt_mac(const struct crypt *c, const void *data, size_t n,
               unsigned char out[CRYPT_HASH]);

/* crypt_public(c, out): what crypt_verify() takes for the signatures of crypt_sign(). */
void crypt_public(const struct crypt *c, unsigned char out[CRYPT_KEY]);
void crypt_sign(const struct crypt *c, const void *data, size_t n,
                unsigned char out[CRYPT_SIGN]);
_Bool crypt_verify(const unsigned char public[CRYPT_KEY], const void *data, size_t n,
                   const unsigned char signature[CRYPT_SIGN]);

#endif
