#include "row_crypt.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "store_rules.h"

#define DIGEST 32

enum { ABOUT = 'a', MODEL = 'm' }; /* the parts of a template that are encrypted */

/* ---- finding */

void row_crypt_lookup(const struct vault *v, const char *subject,
                      unsigned char out[VAULT_HASH])
{
    vault_lookup(v, "subject", subject, strlen(subject), out);
}

void row_crypt_ref(const struct vault *v, const char *subject,
                   unsigned char out[ROW_CRYPT_REF])
{
    unsigned char hash[VAULT_HASH];

    vault_lookup(v, "event", subject, strlen(subject), hash);
    memcpy(out, hash, ROW_CRYPT_REF);
}

static void find_digest(const struct vault *v, const char *what,
                        const unsigned char uid[ROW_CRYPT_UID], const char *digest,
                        unsigned char out[VAULT_HASH])
{
    unsigned char data[ROW_CRYPT_UID + 2 * DIGEST];

    memcpy(data, uid, ROW_CRYPT_UID);
    memcpy(data + ROW_CRYPT_UID, digest, 2 * DIGEST);
    vault_lookup(v, what, data, sizeof data, out);
}

void row_crypt_same(const struct vault *v, const unsigned char uid[ROW_CRYPT_UID],
                    const char *digest, unsigned char out[VAULT_HASH])
{
    find_digest(v, "template", uid, digest, out);
}

void row_crypt_cloud(const struct vault *v, const unsigned char uid[ROW_CRYPT_UID],
                     const char *digest, unsigned char out[VAULT_HASH])
{
    find_digest(v, "cloud", uid, digest, out);
}

/* ---- keys */

void row_crypt_new(const struct vault *v, const unsigned char *uid,
                   struct row_crypt_key *k, unsigned char wrapped[VAULT_WRAPPED])
{
    randombytes_buf(k, sizeof *k);
    if (uid != NULL)
        memcpy(k->uid, uid, sizeof k->uid);
    vault_wrap(v, k->uid, k->key, wrapped);
}

bool row_crypt_key(const struct vault *v, const unsigned char uid[ROW_CRYPT_UID],
                   const unsigned char wrapped[VAULT_WRAPPED], struct row_crypt_key *k)
{
    memcpy(k->uid, uid, ROW_CRYPT_UID);
    return vault_unwrap(v, uid, wrapped, k->key);
}

/* ---- subjects */

static size_t about_subject(const struct row_crypt_key *k, const struct store_subject *s,
                            unsigned char out[ROW_CRYPT_ABOUT])
{
    unsigned char *to = out;

    bytes_put(&to, "surface who   1", 16);
    bytes_put(&to, k->uid, ROW_CRYPT_UID);
    bytes_put_text(&to, s->created);
    bytes_put_text(&to, s->expires);
    bytes_put_number(&to, s->hold, 1);
    bytes_put_number(&to, s->disabled, 1);
    return (size_t)(to - out);
}

size_t row_crypt_encrypt_subject(const struct row_crypt_key *k,
                                 const struct store_subject *s,
                                 unsigned char out[ROW_CRYPT_ABOUT])
{
    unsigned char about[ROW_CRYPT_ABOUT], plain[ROW_CRYPT_ABOUT];
    const size_t n = about_subject(k, s, about);
    unsigned char *to = plain;
    size_t len;

    bytes_put_text(&to, s->id);
    bytes_put_text(&to, s->reference);
    bytes_put_text(&to, s->purpose);
    len = (size_t)(to - plain);
    vault_encrypt(k->key, about, n, plain, len, out);
    sodium_memzero(plain, len);
    return len + VAULT_OVER;
}

bool row_crypt_decrypt_subject(const struct row_crypt_key *k, const void *in, size_t n,
                               struct store_subject *s)
{
    unsigned char about[ROW_CRYPT_ABOUT], plain[ROW_CRYPT_ABOUT];
    const size_t nabout = about_subject(k, s, about);
    struct bytes b = {plain, plain};
    bool ok;

    if (n < VAULT_OVER || n > ROW_CRYPT_ABOUT ||
        !vault_decrypt(k->key, about, nabout, in, n, plain))
        return false;
    b.end += n - VAULT_OVER;
    ok = bytes_get_text(&b, s->id, sizeof s->id) && store_subject_valid(s->id) &&
         bytes_get_text(&b, s->reference, sizeof s->reference) &&
         bytes_get_text(&b, s->purpose, sizeof s->purpose) && b.at == b.end;
    sodium_memzero(plain, n - VAULT_OVER);
    return ok;
}

/* ---- templates */

static size_t about_template(const struct row_crypt_key *k,
                             const struct store_template *t, char part,
                             unsigned char out[ROW_CRYPT_ABOUT])
{
    unsigned char *to = out;

    bytes_put(&to, "surface face  1", 16);
    bytes_put_number(&to, (unsigned char)part, 1);
    bytes_put(&to, k->uid, ROW_CRYPT_UID);
    bytes_put_text(&to, t->id);
    bytes_put_text(&to, t->created);
    bytes_put_text(&to, t->engine);
    bytes_put_number(&to, t->points, 4);
    bytes_put_number(&to, t->triangles, 4);
    if (part == MODEL)
        bytes_put_text(&to, t->digest);
    return (size_t)(to - out);
}

size_t row_crypt_encrypt_template(const struct row_crypt_key *k,
                                  const struct store_template *t,
                                  unsigned char out[ROW_CRYPT_ABOUT])
{
    unsigned char about[ROW_CRYPT_ABOUT], plain[ROW_CRYPT_ABOUT], digest[DIGEST];
    const size_t n = about_template(k, t, ABOUT, about);
    unsigned char *to = plain;
    size_t len;

    (void)sodium_hex2bin(digest, sizeof digest, t->digest, 2 * DIGEST, NULL, NULL, NULL);
    bytes_put_text(&to, t->label);
    bytes_put(&to, digest, sizeof digest);
    bytes_put_real(&to, t->quality.score);
    bytes_put_real(&to, t->quality.coverage);
    bytes_put_real(&to, t->quality.density_mm);
    bytes_put_real(&to, t->quality.noise_mm);
    bytes_put_number(&to, t->manager, 1);
    bytes_put_real(&to, t->first_score);
    len = (size_t)(to - plain);
    vault_encrypt(k->key, about, n, plain, len, out);
    sodium_memzero(plain, len);
    return len + VAULT_OVER;
}

bool row_crypt_decrypt_template(const struct row_crypt_key *k, const void *in, size_t n,
                                struct store_template *t)
{
    unsigned char about[ROW_CRYPT_ABOUT], plain[ROW_CRYPT_ABOUT], digest[DIGEST];
    const size_t nabout = about_template(k, t, ABOUT, about);
    struct bytes b = {plain, plain};
    uint64_t manager;
    bool ok;

    if (n < VAULT_OVER || n > ROW_CRYPT_ABOUT ||
        !vault_decrypt(k->key, about, nabout, in, n, plain))
        return false;
    b.end += n - VAULT_OVER;
    ok = bytes_get_text(&b, t->label, sizeof t->label) &&
         bytes_get(&b, digest, sizeof digest) &&
         bytes_get_real(&b, 1, &t->quality.score) &&
         bytes_get_real(&b, 1, &t->quality.coverage) &&
         bytes_get_real(&b, 1e6, &t->quality.density_mm) &&
         bytes_get_real(&b, 1e6, &t->quality.noise_mm) &&
         bytes_get_number(&b, 1, &manager) && manager <= 1 &&
         bytes_get_finite(&b, &t->first_score) && b.at == b.end;
    t->manager = ok && manager == 1;
    (void)sodium_bin2hex(t->digest, sizeof t->digest, digest, sizeof digest);
    sodium_memzero(plain, n - VAULT_OVER);
    return ok;
}

void row_crypt_encrypt_model(const struct row_crypt_key *k,
                             const struct store_template *t, const void *in, size_t n,
                             unsigned char *out)
{
    unsigned char about[ROW_CRYPT_ABOUT];
    const size_t nabout = about_template(k, t, MODEL, about);

    vault_encrypt(k->key, about, nabout, in, n, out);
}

bool row_crypt_decrypt_model(const struct row_crypt_key *k,
                             const struct store_template *t, const void *in, size_t n,
                             unsigned char *out)
{
    unsigned char about[ROW_CRYPT_ABOUT];
    const size_t nabout = about_template(k, t, MODEL, about);

    return vault_decrypt(k->key, about, nabout, in, n, out);
}
