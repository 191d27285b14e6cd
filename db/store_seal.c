#include "store_seal.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "store_rules.h"

#define DIGEST 32

/* ---- finding */

void store_seal_lookup(const struct vault *v, const char *subject,
                       unsigned char out[VAULT_HASH])
{
    vault_lookup(v, "subject", subject, strlen(subject), out);
}

void store_seal_ref(const struct vault *v, const char *subject,
                    unsigned char out[STORE_SEAL_REF])
{
    unsigned char hash[VAULT_HASH];

    vault_lookup(v, "event", subject, strlen(subject), hash);
    memcpy(out, hash, STORE_SEAL_REF);
}

void store_seal_same(const struct vault *v, const unsigned char uid[STORE_SEAL_UID],
                     const char *digest, unsigned char out[VAULT_HASH])
{
    unsigned char data[STORE_SEAL_UID + 2 * DIGEST];

    memcpy(data, uid, STORE_SEAL_UID);
    memcpy(data + STORE_SEAL_UID, digest, 2 * DIGEST);
    vault_lookup(v, "template", data, sizeof data, out);
}

/* ---- keys */

void store_seal_new(const struct vault *v, const unsigned char *uid,
                    struct store_seal_key *k, unsigned char wrapped[VAULT_WRAPPED])
{
    randombytes_buf(k, sizeof *k);
    if (uid != NULL)
        memcpy(k->uid, uid, sizeof k->uid);
    vault_wrap(v, k->uid, k->key, wrapped);
}

bool store_seal_key(const struct vault *v, const unsigned char uid[STORE_SEAL_UID],
                    const unsigned char wrapped[VAULT_WRAPPED], struct store_seal_key *k)
{
    memcpy(k->uid, uid, STORE_SEAL_UID);
    return vault_unwrap(v, uid, wrapped, k->key);
}

/* ---- subjects */

static size_t about_subject(const struct store_seal_key *k, const struct store_subject *s,
                            unsigned char out[STORE_SEAL_ABOUT])
{
    unsigned char *to = out;

    bytes_put(&to, "surface who   1", 16);
    bytes_put(&to, k->uid, STORE_SEAL_UID);
    bytes_put_text(&to, s->created);
    bytes_put_text(&to, s->expires);
    bytes_put_number(&to, s->hold, 1);
    bytes_put_number(&to, s->disabled, 1);
    return (size_t)(to - out);
}

size_t store_seal_subject(const struct store_seal_key *k, const struct store_subject *s,
                          unsigned char out[STORE_SEAL_ABOUT])
{
    unsigned char about[STORE_SEAL_ABOUT], open[STORE_SEAL_ABOUT];
    const size_t n = about_subject(k, s, about);
    unsigned char *to = open;
    size_t len;

    bytes_put_text(&to, s->id);
    bytes_put_text(&to, s->reference);
    bytes_put_text(&to, s->purpose);
    len = (size_t)(to - open);
    vault_seal(k->key, about, n, open, len, out);
    sodium_memzero(open, len);
    return len + VAULT_OVER;
}

bool store_seal_open_subject(const struct store_seal_key *k, const void *in, size_t n,
                             struct store_subject *s)
{
    unsigned char about[STORE_SEAL_ABOUT], open[STORE_SEAL_ABOUT];
    const size_t nabout = about_subject(k, s, about);
    struct bytes b = {open, open};
    bool ok;

    if (n < VAULT_OVER || n > STORE_SEAL_ABOUT ||
        !vault_unseal(k->key, about, nabout, in, n, open))
        return false;
    b.end += n - VAULT_OVER;
    ok = bytes_get_text(&b, s->id, sizeof s->id) && store_subject_valid(s->id) &&
         bytes_get_text(&b, s->reference, sizeof s->reference) &&
         bytes_get_text(&b, s->purpose, sizeof s->purpose) && b.at == b.end;
    sodium_memzero(open, n - VAULT_OVER);
    return ok;
}

/* ---- templates */

static size_t about_template(const struct store_seal_key *k,
                             const struct store_template *t, char part,
                             unsigned char out[STORE_SEAL_ABOUT])
{
    unsigned char *to = out;

    bytes_put(&to, "surface face  1", 16);
    bytes_put_number(&to, (unsigned char)part, 1);
    bytes_put(&to, k->uid, STORE_SEAL_UID);
    bytes_put_text(&to, t->id);
    bytes_put_text(&to, t->created);
    bytes_put_text(&to, t->engine);
    bytes_put_number(&to, t->points, 4);
    bytes_put_number(&to, t->triangles, 4);
    return (size_t)(to - out);
}

size_t store_seal_template(const struct store_seal_key *k, const struct store_template *t,
                           unsigned char out[STORE_SEAL_ABOUT])
{
    unsigned char about[STORE_SEAL_ABOUT], open[STORE_SEAL_ABOUT], digest[DIGEST];
    const size_t n = about_template(k, t, 'a', about);
    unsigned char *to = open;
    size_t len;

    (void)sodium_hex2bin(digest, sizeof digest, t->digest, 2 * DIGEST, NULL, NULL, NULL);
    bytes_put_text(&to, t->label);
    bytes_put(&to, digest, sizeof digest);
    bytes_put_real(&to, t->quality.score);
    bytes_put_real(&to, t->quality.coverage);
    bytes_put_real(&to, t->quality.density_mm);
    bytes_put_real(&to, t->quality.noise_mm);
    len = (size_t)(to - open);
    vault_seal(k->key, about, n, open, len, out);
    sodium_memzero(open, len);
    return len + VAULT_OVER;
}

bool store_seal_open_template(const struct store_seal_key *k, const void *in, size_t n,
                              struct store_template *t)
{
    unsigned char about[STORE_SEAL_ABOUT], open[STORE_SEAL_ABOUT], digest[DIGEST];
    const size_t nabout = about_template(k, t, 'a', about);
    struct bytes b = {open, open};
    bool ok;

    if (n < VAULT_OVER || n > STORE_SEAL_ABOUT ||
        !vault_unseal(k->key, about, nabout, in, n, open))
        return false;
    b.end += n - VAULT_OVER;
    ok = bytes_get_text(&b, t->label, sizeof t->label) &&
         bytes_get(&b, digest, sizeof digest) &&
         bytes_get_real(&b, 1, &t->quality.score) &&
         bytes_get_real(&b, 1, &t->quality.coverage) &&
         bytes_get_real(&b, 1e6, &t->quality.density_mm) &&
         bytes_get_real(&b, 1e6, &t->quality.noise_mm) && b.at == b.end;
    (void)sodium_bin2hex(t->digest, sizeof t->digest, digest, sizeof digest);
    sodium_memzero(open, n - VAULT_OVER);
    return ok;
}

void store_seal_model(const struct store_seal_key *k, const struct store_template *t,
                      const void *in, size_t n, unsigned char *out)
{
    unsigned char about[STORE_SEAL_ABOUT];
    const size_t nabout = about_template(k, t, 'm', about);

    vault_seal(k->key, about, nabout, in, n, out);
}

bool store_seal_open_model(const struct store_seal_key *k, const struct store_template *t,
                           const void *in, size_t n, unsigned char *out)
{
    unsigned char about[STORE_SEAL_ABOUT];
    const size_t nabout = about_template(k, t, 'm', about);

    return vault_unseal(k->key, about, nabout, in, n, out);
}
