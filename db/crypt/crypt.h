/* crypt.h -- the keys of a database, and what they encrypt.
 *
 *   master key, kept outside     wraps the root's secrets and every subject's key
 *   root: lookup, mac, signing   find a subject without storing its id; authenticate the audit log
 *   a subject's own random key   encrypts everything about the subject; without it no copy of the
 *                                rows can be read
 *
 * Encryption is XChaCha20-Poly1305 (libsodium) with a random nonce, which stands first.  The associated
 * data name the row and the column, so that no ciphertext can be moved or exchanged.  Keys are in locked
 * memory with guard pages, and are wiped before their release.  Never print them.  Any number of threads
 * may use a struct crypt: it never changes. */
#ifndef DB_CRYPT_H
#define DB_CRYPT_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct crypt;

#define CRYPT_KEY        32                       /* bytes of any key */
#define CRYPT_OVER       40                       /* bytes added by encryption */
#define CRYPT_WRAPPED    (CRYPT_KEY + CRYPT_OVER) /* an encrypted key */
#define CRYPT_HASH       32                       /* bytes of a lookup or a MAC */
#define CRYPT_SIGN       64                       /* bytes of a signature: Ed25519 */
#define CRYPT_SALT       16
#define CRYPT_SECRETS    (3 * CRYPT_KEY)
#define CRYPT_SECRET_MAX 1024 /* bytes of a passphrase */

/* Source of the master key; stored, so never renumbered. */
enum crypt_kind {
    CRYPT_PLAINTEXT = 0, /* the root itself: the database can be read without a key */
    CRYPT_FILE = 1,      /* 256 random bits in a file */
    CRYPT_PASSPHRASE = 2 /* Argon2id of a passphrase */
};

struct crypt_root { /* the key record of a database */
    enum crypt_kind kind;
    uint32_t passes, mib;               /* parameters of Argon2id; 0: another kind */
    unsigned char salt[CRYPT_SALT];     /* random bytes that also name the master key */
    unsigned char plaintext[CRYPT_KEY]; /* master key if CRYPT_PLAINTEXT, else zeros */
    unsigned char public[CRYPT_KEY];    /* key that verifies signatures */
    unsigned char secrets[CRYPT_SECRETS + CRYPT_OVER];
};

/* crypt_make(kind, secret, len, root, out, e): Makes new secrets under a master key.
 *   secret  CRYPT_FILE: 32 bytes; CRYPT_PASSPHRASE: 1 to CRYPT_SECRET_MAX bytes; CRYPT_PLAINTEXT: none
 *   out     the keys, to be released by crypt_free()
 * Cost: Argon2id takes 0.3 s and 128 MB.
 * Returns ST_OK; ST_EINVAL: len is wrong; ST_ENOMEM. */
enum status crypt_make(enum crypt_kind kind, const void *secret, size_t len,
                       struct crypt_root *root, struct crypt **out, struct errinfo *e);

/* crypt_open(root, secret, len, out, e): Opens a root, which may come from anyone.  Arguments as in crypt_make().
 * Returns ST_OK; ST_EDENIED: secret is not its master key, or the root was modified; ST_ECORRUPT: a value
 * is impossible; ST_EINVAL, ST_ENOMEM. */
enum status crypt_open(const struct crypt_root *root, const void *secret, size_t len,
                       struct crypt **out, struct errinfo *e);

/* crypt_free(v): Wipes and releases the keys; NULL is allowed. */
void crypt_free(struct crypt *v);

/* crypt_encrypt(key, about, nabout, in, n, out): Encrypts n bytes to n + CRYPT_OVER bytes.
 *   about  associated data */
void crypt_encrypt(const unsigned char key[CRYPT_KEY], const void *about, size_t nabout,
                   const void *in, size_t n, unsigned char *out);

/* crypt_decrypt(key, about, nabout, in, n, out): Decrypts n bytes to n - CRYPT_OVER bytes.  Returns false if they
 * were not encrypted with this key and these associated data; *out is then undefined. */
_Bool crypt_decrypt(const unsigned char key[CRYPT_KEY], const void *about, size_t nabout,
                    const void *in, size_t n, unsigned char *out);

/* crypt_wrap(c, what, name, in, out): Encrypts 32 bytes under the master key: a subject's key, or the digest of
 * an entry.
 *   what  label of the use
 *   name  name of the row */
void crypt_wrap(const struct crypt *c, const char what[16], const unsigned char name[16],
                const unsigned char in[CRYPT_KEY], unsigned char out[CRYPT_WRAPPED]);

/* crypt_unwrap(c, what, name, wrapped, out): Decrypts the output of crypt_wrap().  Returns false if it was made with
 * another key, label or name. */
_Bool crypt_unwrap(const struct crypt *c, const char what[16],
                   const unsigned char name[16],
                   const unsigned char wrapped[CRYPT_WRAPPED],
                   unsigned char out[CRYPT_KEY]);

/* crypt_lookup(c, what, data, n, out): Computes a keyed hash of n bytes, by which a row is found.  It stays the
 * same until a rekey.
 *   what  word that separates the uses */
void crypt_lookup(const struct crypt *c, const char *what, const void *data, size_t n,
                  unsigned char out[CRYPT_HASH]);

/* crypt_mac(c, data, n, out): Computes a MAC of n bytes. */
void crypt_mac(const struct crypt *c, const void *data, size_t n,
               unsigned char out[CRYPT_HASH]);

/* crypt_public(c, out): Copies the public key. */
void crypt_public(const struct crypt *c, unsigned char out[CRYPT_KEY]);

/* crypt_sign(c, data, n, out): Signs n bytes. */
void crypt_sign(const struct crypt *c, const void *data, size_t n,
                unsigned char out[CRYPT_SIGN]);

/* crypt_verify(public, data, n, signature): Returns true if this key has signed the bytes. */
_Bool crypt_verify(const unsigned char public[CRYPT_KEY], const void *data, size_t n,
                   const unsigned char signature[CRYPT_SIGN]);

#endif
