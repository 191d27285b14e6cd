#include "store_chain.h"

#include <sodium.h>
#include <string.h>

#include "vault.h"

static void add_number(crypto_generichash_state *h, uint64_t v, size_t bytes)
{
    unsigned char out[8];

    for (size_t i = 0; i < bytes; i++)
        out[i] = (unsigned char)(v >> 8 * i);
    (void)crypto_generichash_update(h, out, bytes);
}

/* With its length, so that no two entries have the same bytes. */
static void add_bytes(crypto_generichash_state *h, const void *data, size_t n)
{
    add_number(h, n, 2);
    (void)crypto_generichash_update(h, data, n);
}

void store_chain_next(const unsigned char before[STORE_CHAIN_HASH],
                      const struct store_chain_entry *entry,
                      unsigned char out[STORE_CHAIN_HASH])
{
    const char *const text[] = {entry->at, entry->kind, entry->actor, entry->template_id,
                                entry->outcome};
    crypto_generichash_state h;

    (void)crypto_generichash_init(&h, NULL, 0, STORE_CHAIN_HASH);
    (void)crypto_generichash_update(&h, (const unsigned char *)"surface event 1", 16);
    (void)crypto_generichash_update(&h, before, STORE_CHAIN_HASH);
    add_number(&h, entry->seq, 8);
    add_bytes(&h, entry->subject, entry->nsubject);
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        add_bytes(&h, text[i], strlen(text[i]));
    (void)crypto_generichash_final(&h, out, STORE_CHAIN_HASH);
}

void store_chain_end(const struct vault *v, uint64_t seq,
                     const unsigned char hash[STORE_CHAIN_HASH],
                     unsigned char mac[STORE_CHAIN_HASH])
{
    unsigned char data[16 + 8 + STORE_CHAIN_HASH];

    memcpy(data, "surface end   1", 16);
    for (int i = 0; i < 8; i++)
        data[16 + i] = (unsigned char)(seq >> 8 * i);
    memcpy(data + 24, hash, STORE_CHAIN_HASH);
    vault_mac(v, data, sizeof data, mac);
}
