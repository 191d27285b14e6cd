#include "store_chain.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"

const char *store_chain_word(enum store_chain chain)
{
    return chain == STORE_CHAIN_CHANGES ? "changes" : "uses";
}

static void add_number(crypto_generichash_state *h, uint64_t v, size_t bytes)
{
    unsigned char out[8];

    bytes_set(out, v, bytes);
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
    add_number(&h, (uint64_t)entry->chain, 1);
    add_number(&h, entry->seq, 8);
    add_bytes(&h, entry->subject, entry->nsubject);
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        add_bytes(&h, text[i], strlen(text[i]));
    add_bytes(&h, entry->object, entry->nobject);
    add_bytes(&h, entry->row, entry->nrow);
    add_number(&h, entry->uses, 8);
    add_bytes(&h, entry->uses_hash, entry->nuses_hash);
    (void)crypto_generichash_final(&h, out, STORE_CHAIN_HASH);
}

void store_chain_end(const struct vault *v, enum store_chain chain, uint64_t seq,
                     const unsigned char hash[STORE_CHAIN_HASH],
                     unsigned char mac[STORE_CHAIN_HASH])
{
    unsigned char data[16 + 1 + 8 + STORE_CHAIN_HASH];

    memcpy(data, "surface end   1", 16);
    bytes_set(data + 16, (uint64_t)chain, 1);
    bytes_set(data + 17, seq, 8);
    memcpy(data + 25, hash, STORE_CHAIN_HASH);
    vault_mac(v, data, sizeof data, mac);
}

/* ---- marks */

#define MARK_TEXT 160

/* What is signed, as text, so that it can be made by hand. */
static size_t mark_text(const struct store_chain_mark *m, char out[MARK_TEXT])
{
    char hash[2 * STORE_CHAIN_HASH + 1];

    (void)sodium_bin2hex(hash, sizeof hash, m->hash, sizeof m->hash);
    return (size_t)snprintf(out, MARK_TEXT,
                            "surface checkpoint 1\n%s\n%" PRIu64 "\n%s\n%s\n",
                            store_chain_word(m->chain), m->seq, m->at, hash);
}

bool store_chain_due(uint64_t seq, const char *kind)
{
    return seq % STORE_CHAIN_EVERY == 0 || strcmp(kind, STORE_CHAIN_SIGN) == 0 ||
           strcmp(kind, STORE_CHAIN_EXPORT) == 0 || strcmp(kind, STORE_CHAIN_RENEW) == 0;
}

void store_chain_sign(const struct vault *v, struct store_chain_mark *m)
{
    char text[MARK_TEXT];

    vault_sign(v, text, mark_text(m, text), m->signature);
}

bool store_chain_signed(const unsigned char public[VAULT_KEY],
                        const struct store_chain_mark *m)
{
    char text[MARK_TEXT];

    return vault_verify(public, text, mark_text(m, text), m->signature);
}

/* ---- a walk */

void store_chain_walk(struct store_chain_walk *w, enum store_chain chain,
                      const unsigned char public[VAULT_KEY], store_chain_report *report,
                      void *arg)
{
    memset(w, 0, sizeof *w);
    w->chain = chain;
    w->report = report;
    w->arg = arg;
    memcpy(w->public, public, VAULT_KEY);
}

void store_chain_problem(struct store_chain_walk *w, uint64_t seq, const char *line)
{
    w->problems++;
    if (w->first == 0 || seq < w->first)
        w->first = seq;
    w->report(w->arg, w->chain, seq, line);
}

/* "entry 5 is", "entries 5 to 9 are", and what is said of them. */
static void tell(struct store_chain_walk *w, uint64_t from, uint64_t to, const char *what)
{
    char line[160];

    if (from == to)
        (void)snprintf(line, sizeof line, "entry %" PRIu64 " is %s", from, what);
    else
        (void)snprintf(line, sizeof line, "entries %" PRIu64 " to %" PRIu64 " are %s",
                       from, to, what);
    store_chain_problem(w, from, line);
}

/* The run of wrong entries, if there is one, ends with the last. */
static void end_run(struct store_chain_walk *w)
{
    if (w->bad != 0)
        tell(w, w->bad, w->seq, "not what was written");
    w->bad = 0;
}

/* Is it the next one?  What lies between is missing. */
static bool come_to(struct store_chain_walk *w, uint64_t seq)
{
    if (seq <= w->seq) {
        end_run(w);
        tell(w, seq, seq, "not in its place");
        return false;
    }
    if (seq > w->seq + 1) {
        end_run(w);
        tell(w, w->seq + 1, seq - 1, "missing");
        w->lost = true;
    }
    return true;
}

void store_chain_base(struct store_chain_walk *uses,
                      const struct store_chain_entry *entry)
{
    if (strcmp(entry->kind, STORE_CHAIN_TRIM) != 0 || entry->nrow != sizeof uses->hash)
        return;
    uses->seq = strtoull(entry->outcome, NULL, 10);
    memcpy(uses->hash, entry->row, sizeof uses->hash);
    memcpy(uses->made, entry->row, sizeof uses->made);
}

/* ---- by which key */

const unsigned char store_chain_key[STORE_CHAIN_OBJECT] = "signing key";

static void turn(struct store_chain_walk *w)
{
    if (w->turns)
        memcpy(w->public, w->publics[w->npublics - 1].key, VAULT_KEY);
    w->turns = false;
}

static void take_key(struct store_chain_walk *w, const struct store_chain_entry *entry)
{
    if (entry->nobject != sizeof store_chain_key || entry->nrow != VAULT_KEY ||
        memcmp(entry->object, store_chain_key, sizeof store_chain_key) != 0 ||
        w->npublics == STORE_CHAIN_KEYS)
        return;
    w->publics[w->npublics].uses = entry->uses;
    memcpy(w->publics[w->npublics].key, entry->row, VAULT_KEY);
    w->turns = true;
    if (w->npublics++ == 0) /* the first, which none was before */
        turn(w);
}

void store_chain_keys(struct store_chain_walk *uses,
                      const struct store_chain_walk *changes)
{
    memcpy(uses->publics, changes->publics, sizeof uses->publics);
    uses->npublics = changes->npublics;
}

bool store_chain_signs(const struct store_chain_walk *changes,
                       const unsigned char public[VAULT_KEY])
{
    return changes->npublics == 0 ||
           memcmp(changes->publics[changes->npublics - 1].key, public, VAULT_KEY) == 0;
}

/* Of changes the one at that entry, of uses the last that was there before it. */
static const unsigned char *key_of(const struct store_chain_walk *w, uint64_t seq)
{
    const unsigned char *key = w->public;

    for (unsigned i = 0; w->chain == STORE_CHAIN_USES && i < w->npublics; i++)
        if (w->publics[i].uses < seq)
            key = w->publics[i].key;
    return key;
}

/* ---- steps */

void store_chain_step(struct store_chain_walk *w, const struct store_chain_entry *entry,
                      const unsigned char hash[STORE_CHAIN_HASH])
{
    unsigned char made[STORE_CHAIN_HASH];
    bool follows;

    if (!come_to(w, entry->seq))
        return;
    turn(w);
    take_key(w, entry);
    store_chain_next(w->hash, entry, made);
    follows = w->lost || memcmp(made, hash, sizeof made) == 0;
    if (!follows) {
        /* Was it the hash alone of the one before that is another? */
        unsigned char other[STORE_CHAIN_HASH];

        store_chain_next(w->made, entry, other);
        follows = memcmp(other, hash, sizeof other) == 0;
    }
    if (follows)
        end_run(w);
    else if (w->bad == 0)
        w->bad = entry->seq;
    memcpy(w->hash, hash, sizeof w->hash);
    memcpy(w->made, w->lost ? hash : made, sizeof w->made);
    w->lost = false;
    w->seq = entry->seq;
}

void store_chain_damaged(struct store_chain_walk *w, uint64_t seq)
{
    if (!come_to(w, seq))
        return;
    if (w->bad == 0)
        w->bad = seq;
    w->lost = true;
    w->seq = seq;
}

void store_chain_pass(struct store_chain_walk *w, const struct store_chain_mark *m)
{
    char line[160];

    if (!store_chain_signed(key_of(w, m->seq), m)) {
        (void)snprintf(line, sizeof line,
                       "the checkpoint of entry %" PRIu64 " is not signed by this key",
                       m->seq);
    } else if (m->seq != w->seq) {
        (void)snprintf(line, sizeof line, "entry %" PRIu64 " was signed and is not there",
                       m->seq);
    } else if (memcmp(m->hash, w->hash, sizeof m->hash) != 0 &&
               memcmp(m->hash, w->made, sizeof m->hash) != 0) {
        (void)snprintf(line, sizeof line,
                       "entry %" PRIu64 " is not the one that was signed: it, or others "
                       "after entry %" PRIu64 ", were replaced",
                       m->seq, w->marked);
    } else {
        w->marks++;
        w->marked = m->seq;
        turn(w); /* it was signed by the key before */
        return;
    }
    store_chain_problem(w, m->seq, line);
}

void store_chain_stop(struct store_chain_walk *w, uint64_t seq,
                      const unsigned char hash[STORE_CHAIN_HASH])
{
    end_run(w);
    w->end = seq;
    if (w->seq < seq)
        tell(w, w->seq + 1, seq, "cut off the end");
    else if (w->seq > seq)
        tell(w, seq + 1, w->seq, "behind the end");
    else if (memcmp(hash, w->hash, sizeof w->hash) != 0 &&
             memcmp(hash, w->made, sizeof w->made) != 0)
        tell(w, seq, seq, "not the one that was the last");
}
