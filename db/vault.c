#include "vault.h"

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

_Static_assert(VAULT_OVER == NONCE + TAG, "nonce and tag");
_Static_assert(VAULT_KEY == crypto_aead_xchacha20poly1305_ietf_KEYBYTES, "keys");
_Static_assert(VAULT_KEY == crypto_sign_SEEDBYTES, "seeds");
_Static_assert(VAULT_KEY == crypto_sign_PUBLICKEYBYTES, "public keys");
_Static_assert(VAULT_SIGN == crypto_sign_BYTES, "signatures");
_Static_assert(VAULT_SALT == crypto_pwhash_SALTBYTES, "salt");

struct vault {
    unsigned char master[VAULT_KEY];
    struct secrets {
        unsigned char lookup[VAULT_KEY], mac[VAULT_KEY], seed[VAULT_KEY];
    } secrets;
    unsigned char sign[crypto_sign_SECRETKEYBYTES];
};

_Static_assert(sizeof(struct secrets) == VAULT_SECRETS, "no padding");

void vault_encrypt(const unsigned char key[VAULT_KEY], const void *about, size_t nabout,
                   const void *in, size_t n, unsigned char *out)
{
    randombytes_buf(out, NONCE);
    (void)crypto_aead_xchacha20poly1305_ietf_encrypt(out + NONCE, NULL, in, n, about,
                                                     nabout, NULL, out, key);
}

_Bool vault_decrypt(const unsigned char key[VAULT_KEY], const void *about, size_t nabout,
                    const void *in, size_t n, unsigned char *out)
{
    const unsigned char *bytes = in;

    return n >= VAULT_OVER &&
           crypto_aead_xchacha20poly1305_ietf_decrypt(
               out, NULL, NULL, bytes + NONCE, n - NONCE, about, nabout, bytes, key) == 0;
}

/* ---- the root */

/* All that a root says but its secrets, which are encrypted with it as associated data:
 * nothing of it can be changed without the master key. */
#define ROOT_ABOUT (16 + 4 + 8 + 4 + 4 + VAULT_SALT + VAULT_KEY + VAULT_KEY)

static void root_about(const struct vault_root *r, unsigned char out[ROOT_ABOUT])
{
    unsigned char *to = out;

    bytes_put(&to, "surface root  1", 16);
    bytes_put_number(&to, (uint64_t)r->kind, 4);
    bytes_put_number(&to, (uint64_t)r->version, 8);
    bytes_put_number(&to, r->passes, 4);
    bytes_put_number(&to, r->mib, 4);
    bytes_put(&to, r->salt, sizeof r->salt);
    bytes_put(&to, r->plaintext, sizeof r->plaintext);
    bytes_put(&to, r->public, sizeof r->public);
}

static void root_mac(const struct vault *v, const struct vault_root *r,
                     unsigned char out[VAULT_HASH])
{
    unsigned char data[ROOT_ABOUT + sizeof r->secrets];

    root_about(r, data);
    memcpy(data + ROOT_ABOUT, r->secrets, sizeof r->secrets);
    vault_mac(v, data, sizeof data, out);
}

_Bool vault_follows(const struct vault *v, const struct vault_root *root)
{
    unsigned char mac[VAULT_HASH];

    root_mac(v, root, mac);
    return sodium_memcmp(mac, root->mac, sizeof mac) == 0;
}

static enum status master_key(const struct vault_root *r, const void *secret, size_t len,
                              unsigned char out[VAULT_KEY], struct errinfo *e)
{
    switch (r->kind) {
    case VAULT_PLAINTEXT:
        memcpy(out, r->plaintext, VAULT_KEY);
        return ST_OK;
    case VAULT_FILE:
        if (len != VAULT_KEY)
            return errinfo_set(e, ST_EINVAL, "a key has %d bytes, not %zu", VAULT_KEY,
                               len);
        memcpy(out, secret, VAULT_KEY);
        return ST_OK;
    default:
        if (len < 1 || len > VAULT_SECRET_MAX)
            return errinfo_set(e, ST_EINVAL, "a passphrase has 1 to %d bytes",
                               VAULT_SECRET_MAX);
        if (crypto_pwhash(out, VAULT_KEY, secret, len, r->salt, r->passes,
                          (size_t)r->mib << 20, crypto_pwhash_ALG_ARGON2ID13) != 0)
            return errinfo_set(e, ST_ENOMEM, "no memory for the passphrase: %u MB",
                               r->mib);
        return ST_OK;
    }
}

static bool root_possible(const struct vault_root *r)
{
    return r->version >= 1 &&
           (r->kind == VAULT_PLAINTEXT || r->kind == VAULT_FILE ||
            (r->kind == VAULT_PASSPHRASE && r->passes >= 1 && r->passes <= MAX_PASSES &&
             r->mib >= 1 && r->mib <= MAX_MIB));
}

/* A root of this kind and the vault behind it, with these secrets; before: NULL for a first. */
static enum status make(enum vault_kind kind, int64_t version, const struct secrets *s,
                        const struct vault *before, const void *secret, size_t len,
                        struct vault_root *root, struct vault **out, struct errinfo *e)
{
    struct vault *v = sodium_malloc(sizeof *v);
    unsigned char about[ROOT_ABOUT];
    enum status st;

    *out = NULL;
    if (v == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    memset(root, 0, sizeof *root);
    root->kind = kind;
    root->version = version;
    if (kind == VAULT_PASSPHRASE) {
        root->passes = PASSES;
        root->mib = MIB;
    }
    randombytes_buf(root->salt, sizeof root->salt);
    if (kind == VAULT_PLAINTEXT)
        randombytes_buf(root->plaintext, sizeof root->plaintext);
    if ((st = master_key(root, secret, len, v->master, e)) != ST_OK) {
        vault_free(v);
        return st;
    }
    v->secrets = *s;
    (void)crypto_sign_seed_keypair(root->public, v->sign, v->secrets.seed);
    root_about(root, about);
    vault_encrypt(v->master, about, sizeof about, &v->secrets, sizeof v->secrets,
                  root->secrets);
    root_mac(before != NULL ? before : v, root, root->mac);
    *out = v;
    return ST_OK;
}

enum status vault_make(enum vault_kind kind, const void *secret, size_t len,
                       struct vault_root *root, struct vault **out, struct errinfo *e)
{
    struct secrets s;
    enum status st;

    randombytes_buf(&s, sizeof s);
    st = make(kind, 1, &s, NULL, secret, len, root, out, e);
    sodium_memzero(&s, sizeof s);
    return st;
}

enum status vault_change(const struct vault *v, const struct vault_root *from,
                         enum vault_kind kind, const void *secret, size_t len,
                         struct vault_root *root, struct vault **out, struct errinfo *e)
{
    return make(kind, from->version + 1, &v->secrets, v, secret, len, root, out, e);
}

enum status vault_renew(const struct vault *v, const struct vault_root *from,
                        enum vault_kind kind, const void *secret, size_t len,
                        struct vault_root *root, struct vault **out, struct errinfo *e)
{
    struct secrets s;
    enum status st;

    randombytes_buf(&s, sizeof s);
    st = make(kind, from->version + 1, &s, v, secret, len, root, out, e);
    sodium_memzero(&s, sizeof s);
    return st;
}

enum status vault_open(const struct vault_root *root, const void *secret, size_t len,
                       struct vault **out, struct errinfo *e)
{
    unsigned char about[ROOT_ABOUT], public[VAULT_KEY];
    struct vault *v;
    enum status st;

    *out = NULL;
    if (!root_possible(root))
        return errinfo_set(e, ST_ECORRUPT, "the database's key record is damaged");
    if ((v = sodium_malloc(sizeof *v)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if ((st = master_key(root, secret, len, v->master, e)) != ST_OK)
        goto fail;
    root_about(root, about);
    st = ST_EDENIED;
    if (!vault_decrypt(v->master, about, sizeof about, root->secrets,
                       sizeof root->secrets, (unsigned char *)&v->secrets)) {
        (void)errinfo_set(
            e, st, "not the key of this database: give its own, or restore a backup");
        goto fail;
    }
    (void)crypto_sign_seed_keypair(public, v->sign, v->secrets.seed);
    *out = v;
    return ST_OK;
fail:
    vault_free(v);
    return st;
}

void vault_free(struct vault *v)
{
    sodium_free(v); /* wipes it */
}

/* ---- a subject's key */

#define WRAP_ABOUT (16 + 16)

static void wrap_about(const unsigned char uid[16], unsigned char out[WRAP_ABOUT])
{
    memcpy(out, "surface key   1", 16);
    memcpy(out + 16, uid, 16);
}

void vault_wrap(const struct vault *v, const unsigned char uid[16],
                const unsigned char key[VAULT_KEY], unsigned char out[VAULT_WRAPPED])
{
    unsigned char about[WRAP_ABOUT];

    wrap_about(uid, about);
    vault_encrypt(v->master, about, sizeof about, key, VAULT_KEY, out);
}

_Bool vault_unwrap(const struct vault *v, const unsigned char uid[16],
                   const unsigned char wrapped[VAULT_WRAPPED],
                   unsigned char key[VAULT_KEY])
{
    unsigned char about[WRAP_ABOUT];

    wrap_about(uid, about);
    return vault_decrypt(v->master, about, sizeof about, wrapped, VAULT_WRAPPED, key);
}

/* ---- hashes and signatures */

void vault_lookup(const struct vault *v, const char *what, const void *data, size_t n,
                  unsigned char out[VAULT_HASH])
{
    crypto_generichash_state h;

    (void)crypto_generichash_init(&h, v->secrets.lookup, VAULT_KEY, VAULT_HASH);
    (void)crypto_generichash_update(&h, (const unsigned char *)what, strlen(what) + 1);
    (void)crypto_generichash_update(&h, data, n);
    (void)crypto_generichash_final(&h, out, VAULT_HASH);
}

void vault_mac(const struct vault *v, const void *data, size_t n,
               unsigned char out[VAULT_HASH])
{
    (void)crypto_generichash(out, VAULT_HASH, data, n, v->secrets.mac, VAULT_KEY);
}

void vault_public(const struct vault *v, unsigned char out[VAULT_KEY])
{
    (void)crypto_sign_ed25519_sk_to_pk(out, v->sign);
}

void vault_sign(const struct vault *v, const void *data, size_t n,
                unsigned char out[VAULT_SIGN])
{
    (void)crypto_sign_detached(out, NULL, data, n, v->sign);
}

_Bool vault_verify(const unsigned char public[VAULT_KEY], const void *data, size_t n,
                   const unsigned char signature[VAULT_SIGN])
{
    return crypto_sign_verify_detached(signature, data, n, public) == 0;
}
