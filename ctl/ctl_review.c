#include "ctl_review.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "json.h"

#define LINE 4096 /* bytes of a file's line, at most */

/* A line as a document; NULL: it is none. */
static struct json_value *read_line(const char *line)
{
    struct json_value *v;

    (void)json_read(line, strlen(line), JSON_MEMBERS, &v, NULL);
    return v;
}

static bool take_text(const struct json_value *v, const char *key, char *out, size_t size)
{
    return json_copy_text(json_member(v, key), out, size);
}

/* null is "". */
static bool take_text_or(const struct json_value *v, const char *key, char *out,
                         size_t size)
{
    out[0] = '\0';
    return json_is_null(json_member(v, key)) || take_text(v, key, out, size);
}

static bool take_hex(const struct json_value *v, const char *key, unsigned char *out,
                     size_t most, size_t *n)
{
    char text[2 * VAULT_SIGN + 1];

    return take_text_or(v, key, text, sizeof text) &&
           sodium_hex2bin(out, most, text, strlen(text), NULL, n, NULL) == 0;
}

static bool take_bytes(const struct json_value *v, const char *key, unsigned char *out,
                       size_t n)
{
    size_t got;

    return take_hex(v, key, out, n, &got) && got == n;
}

struct review { /* of a file: both chains, one after the other */
    struct store_chain_walk walk[STORE_CHAINS];
    unsigned char signer[VAULT_KEY]; /* as given */
    uint64_t uses;                   /* by the last change, the last of them, */
    unsigned char uses_hash[STORE_CHAIN_HASH];
    uint64_t changes, entries; /* that there should be, that there are */
};

/* NULL: it does not say. */
static struct store_chain_walk *walk_of(struct review *v, const struct json_value *line)
{
    char word[16];

    if (!take_text(line, "chain", word, sizeof word))
        return NULL;
    for (int i = 0; i < STORE_CHAINS; i++)
        if (strcmp(word, store_chain_word((enum store_chain)i)) == 0)
            return &v->walk[i];
    return NULL;
}

static bool take_change(const struct json_value *v, struct store_chain_entry *entry,
                        unsigned char object[STORE_CHAIN_OBJECT],
                        unsigned char row[VAULT_HASH],
                        unsigned char uses_hash[STORE_CHAIN_HASH])
{
    return take_hex(v, "object", object, STORE_CHAIN_OBJECT, &entry->nobject) &&
           take_hex(v, "row", row, VAULT_HASH, &entry->nrow) &&
           json_get_count(json_member(v, "uses"), &entry->uses) &&
           take_hex(v, "uses_hash", uses_hash, STORE_CHAIN_HASH, &entry->nuses_hash);
}

static bool walk_entry(struct review *review, struct store_chain_walk *w,
                       const struct json_value *v)
{
    unsigned char ref[16], object[STORE_CHAIN_OBJECT], row[VAULT_HASH],
        uses_hash[STORE_CHAIN_HASH] = {0}, hash[STORE_CHAIN_HASH];
    struct store_audit_entry a;
    struct store_chain_entry entry = {.chain = w->chain,
                                      .at = a.at,
                                      .kind = a.kind,
                                      .actor = a.actor,
                                      .subject = ref,
                                      .template_id = a.template_id,
                                      .outcome = a.outcome,
                                      .object = object,
                                      .row = row,
                                      .uses_hash = uses_hash};

    if (!json_get_count(json_member(v, "seq"), &entry.seq) ||
        !take_text(v, "at", a.at, sizeof a.at) ||
        !take_text(v, "kind", a.kind, sizeof a.kind) ||
        !take_text(v, "actor", a.actor, sizeof a.actor) ||
        !take_hex(v, "subject_ref", ref, sizeof ref, &entry.nsubject) ||
        !take_text_or(v, "template_id", a.template_id, sizeof a.template_id) ||
        !take_text(v, "outcome", a.outcome, sizeof a.outcome) ||
        (w->chain == STORE_CHAIN_CHANGES &&
         !take_change(v, &entry, object, row, uses_hash)) ||
        !take_bytes(v, "hash", hash, sizeof hash))
        return false;
    if (w->chain == STORE_CHAIN_CHANGES) {
        review->uses = entry.uses;
        memcpy(review->uses_hash, uses_hash, sizeof uses_hash);
        store_chain_base(&review->walk[STORE_CHAIN_USES], &entry);
    }
    store_chain_step(w, &entry, hash);
    store_chain_keys(&review->walk[STORE_CHAIN_USES], &review->walk[STORE_CHAIN_CHANGES]);
    review->entries++;
    return true;
}

/* An entry or a checkpoint; false: neither. */
static bool walk_line(struct review *review, const struct json_value *v)
{
    struct store_chain_walk *w = walk_of(review, v);
    struct store_chain_mark m = {.seq = 0};

    if (w == NULL)
        return false;
    if (!json_get_count(json_member(v, "checkpoint"), &m.seq))
        return walk_entry(review, w, v);
    m.chain = w->chain;
    if (!take_text(v, "at", m.at, sizeof m.at) ||
        !take_bytes(v, "hash", m.hash, sizeof m.hash) ||
        !take_bytes(v, "signature", m.signature, sizeof m.signature))
        return false;
    store_chain_pass(w, &m);
    return true;
}

/* The first line: it must be of this format and of the key that is asked for. */
static enum status walk_head(struct ctl *c, FILE *in, struct review *review)
{
    unsigned char public[VAULT_KEY];
    char line[LINE];
    uint64_t version = 0;
    struct json_value *v = NULL;
    enum status st = ST_OK;

    if (fgets(line, sizeof line, in) == NULL || (v = read_line(line)) == NULL ||
        !json_get_count(json_member(v, "surface_audit"), &version) ||
        !json_get_count(json_member(v, "changes"), &review->changes) ||
        !take_bytes(v, "public_key", public, sizeof public))
        st = errinfo_set(&c->e, ST_EINVAL, "%.120s is no audit log", c->args[0]);
    else if (version != 1)
        st = errinfo_set(&c->e, ST_EVERSION, "%.120s is of a newer version", c->args[0]);
    else if (memcmp(public, review->walk[0].public, sizeof public) != 0)
        store_chain_problem(&review->walk[0], 1,
                            "the file is of another key than the one given");
    json_free(v);
    return st;
}

/* The last change is signed, and it names the last of the uses. */
static void walk_ends(struct review *v)
{
    struct store_chain_walk *w = &v->walk[STORE_CHAIN_CHANGES];

    store_chain_stop(w, v->changes > w->seq ? v->changes : w->seq, w->hash);
    if (w->marked < w->seq)
        store_chain_problem(w, w->marked + 1, "no checkpoint follows: it is not signed");
    if (!store_chain_signs(w, v->signer))
        store_chain_problem(w, w->seq, "the key that signs it is not the one given");
    store_chain_stop(&v->walk[STORE_CHAIN_USES], v->uses, v->uses_hash);
}

static enum status walk_file(struct ctl *c, FILE *in, struct review *review)
{
    char line[LINE], text[80];
    const enum status st = walk_head(c, in, review);

    if (st != ST_OK)
        return st;
    for (unsigned long n = 2; fgets(line, sizeof line, in) != NULL; n++) {
        struct json_value *v = read_line(line);

        if (v == NULL || !walk_line(review, v)) {
            (void)snprintf(text, sizeof text, "line %lu of the file is malformed", n);
            store_chain_problem(&review->walk[0], review->walk[0].seq + 1, text);
        }
        json_free(v);
    }
    if (ferror(in))
        return errinfo_set(&c->e, ST_EIO, "%.120s cannot be read", c->args[0]);
    walk_ends(review);
    return ST_OK;
}

enum status ctl_review_file(struct ctl *c, store_chain_report *report,
                            struct store_audit *out)
{
    unsigned char public[VAULT_KEY];
    struct review review = {.uses = 0};
    size_t n = 0;
    FILE *in;
    enum status st;

    memset(out, 0, sizeof *out);
    if (sodium_hex2bin(public, sizeof public, c->public_key, strlen(c->public_key), NULL,
                       &n, NULL) != 0 ||
        n != sizeof public)
        return errinfo_set(&c->e, ST_EINVAL, "a public key is 64 hexadecimal digits");
    if ((in = fopen(c->args[0], "rb")) == NULL)
        return errinfo_set(&c->e, ST_ENOTFOUND, "there is no file %.120s", c->args[0]);
    for (int i = 0; i < STORE_CHAINS; i++)
        store_chain_walk(&review.walk[i], (enum store_chain)i, public, report, c);
    memcpy(review.signer, public, sizeof public);
    st = walk_file(c, in, &review);
    (void)fclose(in);
    out->entries = review.entries;
    for (int i = 0; i < STORE_CHAINS; i++)
        store_walk_add(out, &review.walk[i]);
    return st;
}
