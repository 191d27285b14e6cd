#include "store_seal.h"

#include <math.h>
#include <sodium.h>
#include <string.h>

#define DIGEST 32

/* ---- bytes: numbers are little-endian, a text is its length, two bytes, and itself */

struct bytes {
    unsigned char *at, *end;
};

static void put(struct bytes *b, const void *from, size_t n)
{
    memcpy(b->at, from, n); /* callers' buffers suffice for what is valid */
    b->at += n;
}

static void put_number(struct bytes *b, uint64_t v, int n)
{
    for (int i = 0; i < n; i++)
        *b->at++ = (unsigned char)(v >> 8 * i);
}

static void put_text(struct bytes *b, const char *text)
{
    const size_t n = strlen(text);

    put_number(b, n, 2);
    put(b, text, n);
}

static void put_real(struct bytes *b, double v)
{
    uint64_t bits;

    memcpy(&bits, &v, sizeof bits);
    put_number(b, bits, 8);
}

static bool get(struct bytes *b, void *to, size_t n)
{
    if ((size_t)(b->end - b->at) < n)
        return false;
    memcpy(to, b->at, n);
    b->at += n;
    return true;
}

static bool get_text(struct bytes *b, char *to, size_t size)
{
    unsigned char len[2];
    size_t n;

    to[0] = '\0';
    if (!get(b, len, 2) || (n = len[0] | (size_t)len[1] << 8) >= size || !get(b, to, n) ||
        memchr(to, '\0', n) != NULL)
        return false;
    to[n] = '\0';
    return true;
}

static bool get_real(struct bytes *b, double max, double *out)
{
    unsigned char in[8];
    uint64_t bits = 0;

    if (!get(b, in, 8))
        return false;
    for (int i = 0; i < 8; i++)
        bits |= (uint64_t)in[i] << 8 * i;
    memcpy(out, &bits, sizeof bits);
    return isfinite(*out) && *out >= 0 && *out <= max;
}

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
    struct bytes b = {out, NULL};

    put(&b, "surface who   1", 16);
    put(&b, k->uid, STORE_SEAL_UID);
    put_text(&b, s->created);
    put_text(&b, s->expires);
    put_number(&b, s->hold, 1);
    put_number(&b, s->disabled, 1);
    return (size_t)(b.at - out);
}

size_t store_seal_subject(const struct store_seal_key *k, const struct store_subject *s,
                          unsigned char out[STORE_SEAL_ABOUT])
{
    unsigned char about[STORE_SEAL_ABOUT], open[STORE_SEAL_ABOUT];
    const size_t n = about_subject(k, s, about);
    struct bytes b = {open, NULL};
    size_t len;

    put_text(&b, s->id);
    put_text(&b, s->reference);
    put_text(&b, s->purpose);
    len = (size_t)(b.at - open);
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
    ok = get_text(&b, s->id, sizeof s->id) && store_subject_valid(s->id) &&
         get_text(&b, s->reference, sizeof s->reference) &&
         get_text(&b, s->purpose, sizeof s->purpose) && b.at == b.end;
    sodium_memzero(open, n - VAULT_OVER);
    return ok;
}

/* ---- templates */

static size_t about_template(const struct store_seal_key *k,
                             const struct store_template *t, char part,
                             unsigned char out[STORE_SEAL_ABOUT])
{
    struct bytes b = {out, NULL};

    put(&b, "surface face  1", 16);
    put_number(&b, (unsigned char)part, 1);
    put(&b, k->uid, STORE_SEAL_UID);
    put_text(&b, t->id);
    put_text(&b, t->created);
    put_text(&b, t->engine);
    put_number(&b, t->points, 4);
    put_number(&b, t->triangles, 4);
    return (size_t)(b.at - out);
}

size_t store_seal_template(const struct store_seal_key *k, const struct store_template *t,
                           unsigned char out[STORE_SEAL_ABOUT])
{
    unsigned char about[STORE_SEAL_ABOUT], open[STORE_SEAL_ABOUT], digest[DIGEST];
    const size_t n = about_template(k, t, 'a', about);
    struct bytes b = {open, NULL};
    size_t len;

    (void)sodium_hex2bin(digest, sizeof digest, t->digest, 2 * DIGEST, NULL, NULL, NULL);
    put_text(&b, t->label);
    put(&b, digest, sizeof digest);
    put_real(&b, t->quality.score);
    put_real(&b, t->quality.coverage);
    put_real(&b, t->quality.density_mm);
    put_real(&b, t->quality.noise_mm);
    len = (size_t)(b.at - open);
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
    ok = get_text(&b, t->label, sizeof t->label) && get(&b, digest, sizeof digest) &&
         get_real(&b, 1, &t->quality.score) && get_real(&b, 1, &t->quality.coverage) &&
         get_real(&b, 1e6, &t->quality.density_mm) &&
         get_real(&b, 1e6, &t->quality.noise_mm) && b.at == b.end;
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
