/* vault.h -- the keys of a database, and what they encrypt.
 *
 *   master key, kept outside     wraps the root's secrets and every subject's key
 *   root: lookup, mac, signing   find a subject without storing its id; authenticate the audit log
 *   a subject's own random key   encrypts all that is known of the subject; erasing it erases
 *                                the subject, in whatever copy of the rows is left
 *
 * Encrypted with XChaCha20-Poly1305 (libsodium) under a random nonce, which stands first; the
 * associated data say which row and what in it, so that nothing can be moved or exchanged.
 * Keys lie in locked memory with guard pages and are wiped when they go.  Nothing here is
 * for printing.  Calls are safe from any number of threads: a vault never changes. */
#ifndef DB_VAULT_H
#define DB_VAULT_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct vault;

#define VAULT_KEY        32                       /* bytes of any key */
#define VAULT_OVER       40                       /* more bytes encrypted than plain */
#define VAULT_WRAPPED    (VAULT_KEY + VAULT_OVER) /* an encrypted key */
#define VAULT_HASH       32                       /* of lookups and macs */
#define VAULT_SIGN       64                       /* a signature: Ed25519 */
#define VAULT_SALT       16
#define VAULT_SECRETS    (3 * VAULT_KEY)
#define VAULT_SECRET_MAX 1024 /* bytes of a passphrase */

enum vault_kind { /* where the master key comes from; stored, so never renumbered */
                  VAULT_PLAINTEXT =
                      0, /* the root itself: the database alone suffices to read it */
                  VAULT_FILE = 1,      /* 256 random bits in a file */
                  VAULT_PASSPHRASE = 2 /* by Argon2id */
};

struct vault_root { /* what the database keeps of its vault */
    enum vault_kind kind;
    int64_t version;      /* 1, and one more each time the master key is another */
    uint32_t passes, mib; /* of Argon2id, else 0 */
    unsigned char salt[VAULT_SALT];     /* random, also names the master key */
    unsigned char plaintext[VAULT_KEY]; /* VAULT_PLAINTEXT: the master key, else 0 */
    unsigned char public[VAULT_KEY];    /* what signatures are verified with */
    unsigned char secrets[VAULT_SECRETS + VAULT_OVER];
    unsigned char mac[VAULT_HASH]; /* by the vault before it; of the first by its own */
};

/* vault_make(kind, secret, len, root, out, e): new secrets under a master key.  secret:
 * VAULT_FILE its 32 bytes, VAULT_PASSPHRASE 1 to VAULT_SECRET_MAX, VAULT_PLAINTEXT none.
 * Argon2id takes 0.3 s and 128 MB.  *out is released by vault_free().
 * Returns ST_OK, ST_EINVAL (length), ST_ENOMEM. */
enum status vault_make(enum vault_kind kind, const void *secret, size_t len,
                       struct vault_root *root, struct vault **out, struct errinfo *e);

/* vault_open(root, secret, len, out, e): the vault of a root that may come from anyone.
 * Returns ST_OK; ST_EDENIED: not its master key, or the root was tampered with; ST_ECORRUPT:
 * impossible; ST_EINVAL, ST_ENOMEM. */
enum status vault_open(const struct vault_root *root, const void *secret, size_t len,
                       struct vault **out, struct errinfo *e);

/* vault_change(v, from, kind, secret, len, root, out, e): the same secrets under another
 * master key; *root is the one that follows *from. */
enum status vault_change(const struct vault *v, const struct vault_root *from,
                         enum vault_kind kind, const void *secret, size_t len,
                         struct vault_root *root, struct vault **out, struct errinfo *e);

/* vault_renew(v, from, ...): the same with new secrets, where the old ones are known to others. */
enum status vault_renew(const struct vault *v, const struct vault_root *from,
                        enum vault_kind kind, const void *secret, size_t len,
                        struct vault_root *root, struct vault **out, struct errinfo *e);

/* vault_follows(v, root): is it the root of vault_change(v, ...), vault_renew(v, ...), or
 * of the same secrets?  Takes no master key and no Argon2id: what the vault has not
 * authenticated need not be opened. */
_Bool vault_follows(const struct vault *v, const struct vault_root *root);

void vault_free(struct vault *v); /* wiped; NULL is allowed */

/* vault_encrypt(key, about, nabout, in, n, out): n + VAULT_OVER bytes to out.
 * vault_decrypt(key, about, nabout, in, n, out): n - VAULT_OVER bytes to out; false: other
 * bytes than were encrypted, under another key or about something else, and out is undefined. */
void vault_encrypt(const unsigned char key[VAULT_KEY], const void *about, size_t nabout,
                   const void *in, size_t n, unsigned char *out);
_Bool vault_decrypt(const unsigned char key[VAULT_KEY], const void *about, size_t nabout,
                    const void *in, size_t n, unsigned char *out);

/* A subject's key, bound to the subject's 16 random bytes.  vault_unwrap(): false as above. */
void vault_wrap(const struct vault *v, const unsigned char uid[16],
                const unsigned char key[VAULT_KEY], unsigned char out[VAULT_WRAPPED]);
_Bool vault_unwrap(const struct vault *v, const unsigned char uid[16],
                   const unsigned char wrapped[VAULT_WRAPPED],
                   unsigned char key[VAULT_KEY]);

/* vault_lookup(v, what, data, n, out): a keyed hash of n bytes to find a row by; the same
 * for another master key.  what: a word that keeps one use from another.
 * vault_mac(v, data, n, out): a MAC of the bytes. */
void vault_lookup(const struct vault *v, const char *what, const void *data, size_t n,
                  unsigned char out[VAULT_HASH]);
void vault_mac(const struct vault *v, const void *data, size_t n,
               unsigned char out[VAULT_HASH]);

/* vault_public(v, out): what vault_verify() takes for the signatures of vault_sign(). */
void vault_public(const struct vault *v, unsigned char out[VAULT_KEY]);
void vault_sign(const struct vault *v, const void *data, size_t n,
                unsigned char out[VAULT_SIGN]);
_Bool vault_verify(const unsigned char public[VAULT_KEY], const void *data, size_t n,
                   const unsigned char signature[VAULT_SIGN]);

#endif
