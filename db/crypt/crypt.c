#include "crypt.h"

#include <sodium.h>
#include <stdbool.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"

/* Of a new passphrase; the root may ask for more, up to the limits. */
#define PASSES     3
#define MIB        128
#define MAX_PASSES 16
#define MAX_MIB    1024

#define NONCE crypto_aead_xchacha20poly1305_ietf_NPUBBYTES
#define TAG   crypto_aead_xchacha20poly1305_ietf_ABYTES

_Static_assert(CRYPT_OVER == NONCE + TAG, "nonce and tag");
_Static_assert(CRYPT_KEY == crypto_aead_xchacha20poly1305_ietf_KEYBYTES, "keys");
_Static_assert(CRYPT_KEY == crypto_sign_SEEDBYTES, "seeds");
_Static_assert(CRYPT_KEY == crypto_sign_PUBLICKEYBYTES, "public keys");
_Static_assert(CRYPT_SIGN == crypto_sign_BYTES, "signatures");
_Static_assert(CRYPT_SALT == crypto_pwhash_SALTBYTES, "salt");

struct crypt {
    unsigned char master[CRYPT_KEY];
    struct secrets {
        unsigned char lookup[CRYPT_KEY], mac[CRYPT_KEY], seed[CRYPT_KEY];
    } secrets;
    unsigned char sign[crypto_sign_SECRETKEYBYTES];
};

_Static_assert(sizeof(struct secrets) == CRYPT_SECRETS, "no padding");

void crypt_encrypt(const unsigned char key[CRYPT_KEY], const void *about, size_t nabout,
                   const void *in, size_t n, unsigned char *out)
{
    randombytes_buf(out, NONCE);
    (void)crypto_aead_xchacha20poly1305_ietf_encrypt(out + NONCE, NULL, in, n, about,
                                                     nabout, NULL, out, key);
}

_Bool crypt_decrypt(const unsigned char key[CRYPT_KEY], const void *about, size_t nabout,
                    const void *in, size_t n, unsigned char *out)
{
    const unsigned char *bytes = in;

    return n >= CRYPT_OVER &&
           crypto_aead_xchacha20poly1305_ietf_decrypt(
               out, NULL, NULL, bytes + NONCE, n - NONCE, about, nabout, bytes, key) == 0;
}

/* ---- the root */

/* All that a root says but its secrets, which are encrypted with it as associated data:
 * nothing of it can be changed without the master key. */
#define ROOT_ABOUT (16 + 4 + 4 + 4 + CRYPT_SALT + CRYPT_KEY + CRYPT_KEY)

static void root_about(const struct crypt_root *r, unsigned char out[ROOT_ABOUT])
{
    unsigned char *to = out;

    bytes_put(&to, "surface root  1", 16);
    bytes_put_number(&to, (uint64_t)r->kind, 4);
    bytes_put_number(&to, r->passes, 4);
    bytes_put_number(&to, r->mib, 4);
    bytes_put(&to, r->salt, sizeof r->salt);
    bytes_put(&to, r->plaintext, sizeof r->plaintext);
    bytes_put(&to, r->public, sizeof r->public);
}

static enum status master_key(const struct crypt_root *r, const void *secret, size_t len,
                              unsigned char out[CRYPT_KEY], struct errinfo *e)
{
    switch (r->kind) {
    case CRYPT_PLAINTEXT:
        memcpy(out, r->plaintext, CRYPT_KEY);
        return ST_OK;
    case CRYPT_FILE:
        if (len != CRYPT_KEY)
            return errinfo_set(e, ST_EINVAL, "a key has %d bytes, not %zu", CRYPT_KEY,
                               len);
        memcpy(out, secret, CRYPT_KEY);
        return ST_OK;
    default:
        if (len < 1 || len > CRYPT_SECRET_MAX)
            return errinfo_set(e, ST_EINVAL, "a passphrase has 1 to %d bytes",
                               CRYPT_SECRET_MAX);
        if (crypto_pwhash(out, CRYPT_KEY, secret, len, r->salt, r->passes,
                          (size_t)r->mib << 20, crypto_pwhash_ALG_ARGON2ID13) != 0)
            return errinfo_set(e, ST_ENOMEM, "no memory for the passphrase: %u MB",
                               r->mib);
        return ST_OK;
    }
}

static bool root_possible(const struct crypt_root *r)
{
    return r->kind == CRYPT_PLAINTEXT || r->kind == CRYPT_FILE ||
           (r->kind == CRYPT_PASSPHRASE && r->passes >= 1 && r->passes <= MAX_PASSES &&
            r->mib >= 1 && r->mib <= MAX_MIB);
}

enum status crypt_make(enum crypt_kind kind, const void *secret, size_t len,
                       struct crypt_root *root, struct crypt **out, struct errinfo *e)
{
    struct crypt *c = *out = sodium_malloc(sizeof *c);
    unsigned char about[ROOT_ABOUT];
    enum status st;

    if (c == NULL)
        return errinfo_memory(e);
    *root = (struct crypt_root){.kind = kind};
    if (kind == CRYPT_PASSPHRASE) {
        root->passes = PASSES;
        root->mib = MIB;
    }
    randombytes_buf(root->salt, sizeof root->salt);
    if (kind == CRYPT_PLAINTEXT)
        randombytes_buf(root->plaintext, sizeof root->plaintext);
    if ((st = master_key(root, secret, len, c->master, e)) == ST_OK) {
        randombytes_buf(&c->secrets, sizeof c->secrets);
        (void)crypto_sign_seed_keypair(root->public, c->sign, c->secrets.seed);
        root_about(root, about);
        crypt_encrypt(c->master, about, sizeof about, &c->secrets, sizeof c->secrets,
                      root->secrets);
        return ST_OK;
    }
    crypt_free(c);
    *out = NULL;
    return st;
}

enum status crypt_open(const struct crypt_root *root, const void *secret, size_t len,
                       struct crypt **out, struct errinfo *e)
{
    unsigned char about[ROOT_ABOUT], public[CRYPT_KEY];
    struct crypt *c;
    enum status st;

    *out = NULL;
    if (!root_possible(root))
        return errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
    if ((c = *out = sodium_malloc(sizeof *c)) == NULL)
        return errinfo_memory(e);
    root_about(root, about);
    if ((st = master_key(root, secret, len, c->master, e)) == ST_OK &&
        !crypt_decrypt(c->master, about, sizeof about, root->secrets,
                       sizeof root->secrets, (unsigned char *)&c->secrets))
        st = errinfo_set(
            e, ST_EDENIED,
            "not the key of this database: give its own, or restore a backup");
    if (st == ST_OK) {
        (void)crypto_sign_seed_keypair(public, c->sign, c->secrets.seed);
        return ST_OK;
    }
    crypt_free(c);
    *out = NULL;
    return st;
}

void crypt_free(struct crypt *c)
{
    sodium_free(c); /* wipes it */
}

/* ---- small secrets under the master key */

struct wrap_about {
    unsigned char what[16], name[16];
};

static struct wrap_about wrap_about(const char what[16], const unsigned char name[16])
{
    struct wrap_about about;

    memcpy(about.what, what, sizeof about.what);
    memcpy(about.name, name, sizeof about.name);
    return about;
}

void crypt_wrap(const struct crypt *c, const char what[16], const unsigned char name[16],
                const unsigned char in[CRYPT_KEY], unsigned char out[CRYPT_WRAPPED])
{
    const struct wrap_about about = wrap_about(what, name);

    crypt_encrypt(c->master, &about, sizeof about, in, CRYPT_KEY, out);
}

_Bool crypt_unwrap(const struct crypt *c, const char what[16],
                   const unsigned char name[16],
                   const unsigned char wrapped[CRYPT_WRAPPED],
                   unsigned char out[CRYPT_KEY])
{
    const struct wrap_about about = wrap_about(what, name);

    return crypt_decrypt(c->master, &about, sizeof about, wrapped, CRYPT_WRAPPED, out);
}

/* ---- hashes and signatures */

void crypt_lookup(const struct crypt *c, const char *what, const void *data, size_t n,
                  unsigned char out[CRYPT_HASH])
{
    crypto_generichash_state h;

    (void)crypto_generichash_init(&h, c->secrets.lookup, CRYPT_KEY, CRYPT_HASH);
    (void)crypto_generichash_update(&h, (const unsigned char *)what, strlen(what) + 1);
    (void)crypto_generichash_update(&h, data, n);
    (void)crypto_generichash_final(&h, out, CRYPT_HASH);
}

void crypt_mac(const struct crypt *c, const void *data, size_t n,
               unsigned char out[CRYPT_HASH])
{
    (void)crypto_generichash(out, CRYPT_HASH, data, n, c->secrets.mac, CRYPT_KEY);
}

void crypt_public(const struct crypt *c, unsigned char out[CRYPT_KEY])
{
    (void)crypto_sign_ed25519_sk_to_pk(out, c->sign);
}

void crypt_sign(const struct crypt *c, const void *data, size_t n,
                unsigned char out[CRYPT_SIGN])
{
    (void)crypto_sign_detached(out, NULL, data, n, c->sign);
}

_Bool crypt_verify(const unsigned char public[CRYPT_KEY], const void *data, size_t n,
                   const unsigned char signature[CRYPT_SIGN])
{
    return crypto_sign_verify_detached(signature, data, n, public) == 0;
}
