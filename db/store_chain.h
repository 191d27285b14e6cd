/* store_chain.h -- the chains of events: each entry's hash is of the entry and of the hash
 * before it, so that none can be removed, changed or moved without all that follow.  The
 * first follows 32 zero bytes.  Marks are places in a chain that are signed: they bind it
 * for verifiers that have the public key alone.  Layout of what is hashed: db/FORMAT.md. */
#ifndef DB_STORE_CHAIN_H
#define DB_STORE_CHAIN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "store_types.h"
#include "vault.h"

#define STORE_CHAIN_HASH   32
#define STORE_CHAIN_OBJECT 16
#define STORE_CHAIN_EVERY  1000 /* entries from one mark to the next */

/* Kinds of events that are marked too. */
#define STORE_CHAIN_SIGN   "checkpoint"
#define STORE_CHAIN_EXPORT "export_audit"

/* The kind of a change that cuts off the oldest uses: outcome has the number of the last, row its
 * hash, after which the chain begins from then on. */
#define STORE_CHAIN_TRIM "trim_uses"

/* The kind of a change by which the log is signed with another key from then on.  It is signed
 * with the old one; its object is store_chain_key, and row the new public key.  The first change
 * has the first key so. */
#define STORE_CHAIN_RENEW "renew_key"
#define STORE_CHAIN_KEYS  64 /* at most */
extern const unsigned char store_chain_key[STORE_CHAIN_OBJECT];

struct store_chain_entry {
    enum store_chain chain;
    uint64_t seq; /* 1, 2, ... */
    const char *at, *kind, *actor;
    const unsigned char *subject; /* a reference, row_crypt_ref(), or none */
    size_t nsubject;
    const char *template_id, *outcome;
    const unsigned char *object, *row; /* whose row, and its MAC */
    size_t nobject, nrow;              /* 0 or STORE_CHAIN_OBJECT, 0 or VAULT_HASH */
    uint64_t uses;                     /* the last of the uses, and its hash */
    const unsigned char *uses_hash;
    size_t nuses_hash; /* STORE_CHAIN_HASH; of uses themselves 0 */
};

/* store_chain_next(before, entry, out): BLAKE2b-256; out may be before. */
void store_chain_next(const unsigned char before[STORE_CHAIN_HASH],
                      const struct store_chain_entry *entry,
                      unsigned char out[STORE_CHAIN_HASH]);

/* store_chain_end(v, chain, seq, hash, mac): the MAC of the chain's end. */
void store_chain_end(const struct vault *v, enum store_chain chain, uint64_t seq,
                     const unsigned char hash[STORE_CHAIN_HASH],
                     unsigned char mac[STORE_CHAIN_HASH]);

struct store_chain_mark {
    enum store_chain chain;
    uint64_t seq;
    char at[32];
    unsigned char hash[STORE_CHAIN_HASH]; /* of the entry */
    unsigned char signature[VAULT_SIGN];
};

/* store_chain_due(seq, kind): must this entry have a mark?
 * store_chain_sign(v, m): its signature; store_chain_signed(public, m): is it the one? */
bool store_chain_due(uint64_t seq, const char *kind);
void store_chain_sign(const struct vault *v, struct store_chain_mark *m);
bool store_chain_signed(const unsigned char public[VAULT_KEY],
                        const struct store_chain_mark *m);

/* A walk along a chain that reports what is not as it was written: the entry that it is
 * about, and a line of text.  All is set by store_chain_walk(). */
typedef void store_chain_report(void *arg, enum store_chain chain, uint64_t seq,
                                const char *line);

/* store_chain_word(chain): "changes" or "uses". */
const char *store_chain_word(enum store_chain chain);

struct store_chain_walk {
    store_chain_report *report;
    void *arg;
    unsigned char public[VAULT_KEY];
    enum store_chain chain;
    uint64_t seq;                         /* of the last entry, 0: there was none */
    unsigned char hash[STORE_CHAIN_HASH]; /* that it has, */
    unsigned char made[STORE_CHAIN_HASH]; /* and that it should have */
    uint64_t end;               /* where it should end, once it has come there */
    struct store_chain_public { /* by the changes */
        uint64_t uses;          /* the last that the key before it signed */
        unsigned char key[VAULT_KEY];
    } publics[STORE_CHAIN_KEYS];
    unsigned npublics;
    bool turns;        /* the last one holds from the next entry on */
    bool lost;         /* neither is known: what was there is missing */
    uint64_t bad;      /* the first of the entries that are wrong just now, or 0 */
    uint64_t marked;   /* the last entry with a good mark, 0: none */
    uint64_t marks;    /* good ones */
    uint64_t problems; /* reported */
    uint64_t first;    /* the least entry that one is about */
};

void store_chain_walk(struct store_chain_walk *w, enum store_chain chain,
                      const unsigned char public[VAULT_KEY], store_chain_report *report,
                      void *arg);

/* store_chain_keys(uses, changes): by which keys the uses are signed, as a walk along the changes
 * has found it.
 * store_chain_signs(w, public): does this key sign from the end on?
 * store_chain_base(w, entry): where the chain of the uses begins by an entry of the changes, as the
 * latest of them says.  Before the first step along it.
 * store_chain_step(w, entry, hash): the next entry and the hash that it has.  Each is held
 * against the one before; a run of wrong ones is one report.
 * store_chain_damaged(w, seq): an entry that cannot be read.
 * store_chain_pass(w, m): a mark of the entry just stepped to.
 * store_chain_stop(w, seq, hash): the chain should end here (store_chain_end()). */
void store_chain_keys(struct store_chain_walk *uses,
                      const struct store_chain_walk *changes);
bool store_chain_signs(const struct store_chain_walk *changes,
                       const unsigned char public[VAULT_KEY]);
void store_chain_base(struct store_chain_walk *uses,
                      const struct store_chain_entry *entry);
void store_chain_step(struct store_chain_walk *w, const struct store_chain_entry *entry,
                      const unsigned char hash[STORE_CHAIN_HASH]);
void store_chain_damaged(struct store_chain_walk *w, uint64_t seq);
void store_chain_pass(struct store_chain_walk *w, const struct store_chain_mark *m);
void store_chain_stop(struct store_chain_walk *w, uint64_t seq,
                      const unsigned char hash[STORE_CHAIN_HASH]);

/* store_chain_problem(w, seq, line): report a problem of the caller's own. */
void store_chain_problem(struct store_chain_walk *w, uint64_t seq, const char *line);

#endif
