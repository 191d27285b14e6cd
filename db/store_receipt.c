#include "store_receipt.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIGNED_TEXT 192

static void add_line(crypto_hash_sha256_state *h, const char *text)
{
    (void)crypto_hash_sha256_update(h, (const unsigned char *)text, strlen(text));
    (void)crypto_hash_sha256_update(h, (const unsigned char *)"\n", 1);
}

/* As text, so that it can be made by hand. */
static void digest(const struct store_receipt *r, char out[65])
{
    unsigned char hash[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state h;

    (void)crypto_hash_sha256_init(&h);
    add_line(&h, "surface erasure 2");
    add_line(&h, r->subject);
    add_line(&h, r->uid);
    add_line(&h, r->at);
    for (uint32_t i = 0; i < r->templates; i++)
        add_line(&h, r->template_id[i]);
    (void)crypto_hash_sha256_final(&h, hash);
    (void)sodium_bin2hex(out, 65, hash, sizeof hash);
}

static size_t signed_text(const struct store_receipt *r, char out[SIGNED_TEXT])
{
    return (size_t)snprintf(out, SIGNED_TEXT, "surface receipt 2\n%s\n%" PRIu64 "\n%s\n",
                            r->digest, r->seq, r->hash);
}

void store_receipt_sign(const struct crypt *c, struct store_receipt *r)
{
    unsigned char public[CRYPT_KEY], signature[CRYPT_SIGN];
    char text[SIGNED_TEXT];

    digest(r, r->digest);
    crypt_sign(c, text, signed_text(r, text), signature);
    crypt_public(c, public);
    (void)sodium_bin2hex(r->signature, sizeof r->signature, signature, sizeof signature);
    (void)sodium_bin2hex(r->public_key, sizeof r->public_key, public, sizeof public);
}

static bool read_hex(const char *text, unsigned char *out, size_t n)
{
    size_t got = 0;

    return sodium_hex2bin(out, n, text, strlen(text), NULL, &got, NULL) == 0 && got == n;
}

bool store_receipt_true(const struct store_receipt *r)
{
    unsigned char public[CRYPT_KEY], signature[CRYPT_SIGN];
    char wanted[65], text[SIGNED_TEXT];

    digest(r, wanted);
    return strcmp(wanted, r->digest) == 0 &&
           read_hex(r->public_key, public, sizeof public) &&
           read_hex(r->signature, signature, sizeof signature) &&
           crypt_verify(public, text, signed_text(r, text), signature);
}

void store_receipt_free(struct store_receipt *r)
{
    free(r->template_id);
    r->template_id = NULL;
    r->templates = 0;
}
