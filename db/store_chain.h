/* store_chain.h -- the chain of events: each entry's hash is of the entry and of the hash
 * before it, so that none can be removed, changed or moved without all that follow.  The
 * first follows 32 zero bytes.  Layout of what is hashed: db/FORMAT.md. */
#ifndef DB_STORE_CHAIN_H
#define DB_STORE_CHAIN_H
#include <stddef.h>
#include <stdint.h>

#define STORE_CHAIN_HASH 32

struct vault; /* vault.h */

struct store_chain_entry {
    uint64_t seq; /* 1, 2, ... */
    const char *at, *kind, *actor;
    const unsigned char *subject; /* a reference, store_seal_ref(), or none */
    size_t nsubject;
    const char *template_id, *outcome;
};

/* store_chain_next(before, entry, out): BLAKE2b-256; out may be before. */
void store_chain_next(const unsigned char before[STORE_CHAIN_HASH],
                      const struct store_chain_entry *entry,
                      unsigned char out[STORE_CHAIN_HASH]);

/* store_chain_end(v, seq, hash, mac): proves that the chain ends there. */
void store_chain_end(const struct vault *v, uint64_t seq,
                     const unsigned char hash[STORE_CHAIN_HASH],
                     unsigned char mac[STORE_CHAIN_HASH]);

#endif
