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
    char text[2 * CRYPT_WRAPPED + 1]; /* the longest */

    return take_text_or(v, key, text, sizeof text) &&
           sodium_hex2bin(out, most, text, strlen(text), NULL, n, NULL) == 0;
}

static bool take_bytes(const struct json_value *v, const char *key, unsigned char *out,
                       size_t n)
{
    size_t got;

    return take_hex(v, key, out, n, &got) && got == n;
}

static bool take_change(const struct json_value *v, struct log_entry *entry)
{
    size_t n = 0;

    if (!take_bytes(v, "digest", entry->digest, sizeof entry->digest) ||
        !json_get_count(json_member(v, "access_seq"), &entry->accesses.seq) ||
        !take_bytes(v, "access_hash", entry->accesses.hash, LOG_HASH) ||
        !take_hex(v, "signature", entry->signature, sizeof entry->signature, &n))
        return false;
    entry->is_signed = n == sizeof entry->signature;
    return entry->is_signed || n == 0;
}

/* False: it is no entry, or one of the changes behind the accesses. */
static bool walk_line(struct log_walk *w, const struct json_value *v)
{
    struct log_entry entry = {.seq = 0};
    char word[16];
    size_t n;

    if (!take_text(v, "log", word, sizeof word))
        return false;
    if (strcmp(word, log_word(LOG_ACCESSES)) == 0)
        entry.log = LOG_ACCESSES;
    else if (strcmp(word, log_word(LOG_CHANGES)) != 0 || w->log == LOG_ACCESSES)
        return false;
    if (!json_get_count(json_member(v, "seq"), &entry.seq) ||
        !take_text(v, "at", entry.at, sizeof entry.at) ||
        !take_text(v, "kind", entry.kind, sizeof entry.kind) ||
        !take_text(v, "actor", entry.actor, sizeof entry.actor) ||
        !take_hex(v, "subject_uid", entry.uid, sizeof entry.uid, &n) ||
        (n != 0 && n != sizeof entry.uid) ||
        !take_text_or(v, "object", entry.object, sizeof entry.object) ||
        !take_text(v, "outcome", entry.outcome, sizeof entry.outcome) ||
        (entry.log == LOG_CHANGES && !take_change(v, &entry)) ||
        !take_bytes(v, "hash", entry.hash, sizeof entry.hash))
        return false;
    if (entry.log != w->log)
        log_walk_accesses(w);
    log_walk_step(w, &entry);
    return true;
}

/* The first line: it must be of this format. */
static enum status walk_head(struct ctl *c, FILE *in)
{
    char line[LINE];
    uint64_t version = 0;
    struct json_value *v = NULL;
    enum status st = ST_OK;

    if (fgets(line, sizeof line, in) == NULL || (v = read_line(line)) == NULL ||
        !json_get_count(json_member(v, "surface_audit"), &version))
        st = errinfo_set(&c->e, ST_EINVAL, "%.120s is no audit log", c->args[0]);
    else if (version != 2)
        st = errinfo_set(&c->e, ST_EVERSION, "%.120s is of another version", c->args[0]);
    json_free(v);
    return st;
}

static enum status walk_file(struct ctl *c, FILE *in, struct log_walk *w)
{
    char line[LINE], text[80];
    uint64_t changes = 0;
    const enum status st = walk_head(c, in);

    if (st != ST_OK)
        return st;
    for (unsigned long n = 2; fgets(line, sizeof line, in) != NULL; n++) {
        struct json_value *v = read_line(line);

        if (v == NULL || !walk_line(w, v)) {
            (void)snprintf(text, sizeof text, "line %lu of the file is malformed", n);
            log_walk_problem(w, w->at.seq + 1, text);
        }
        json_free(v);
        if (w->log == LOG_CHANGES)
            changes = w->at.seq;
    }
    if (ferror(in))
        return errinfo_set(&c->e, ST_EIO, "%.120s cannot be read", c->args[0]);
    if (w->log == LOG_CHANGES)
        log_walk_accesses(w);
    log_walk_end(w);
    if (changes == 0 || w->signed_to != changes) {
        (void)snprintf(text, sizeof text,
                       "entries from %" PRIu64 " on are not signed by the key given",
                       w->signed_to + 1);
        w->log = LOG_CHANGES;
        log_walk_problem(w, w->signed_to + 1, text);
    }
    return ST_OK;
}

enum status ctl_review_file(struct ctl *c, log_report *report, struct log_walk *out)
{
    unsigned char public[CRYPT_KEY] = {0};
    size_t n = 0;
    FILE *in;
    enum status st;

    log_walk_begin(out, NULL, public, report, c);
    if (sodium_hex2bin(public, sizeof public, c->public_key, strlen(c->public_key), NULL,
                       &n, NULL) != 0 ||
        n != sizeof public)
        return errinfo_set(&c->e, ST_EINVAL, "a public key is 64 hexadecimal digits");
    if ((in = fopen(c->args[0], "rb")) == NULL)
        return errinfo_set(&c->e, ST_ENOTFOUND, "there is no file %.120s", c->args[0]);
    log_walk_begin(out, NULL, public, report, c);
    st = walk_file(c, in, out);
    (void)fclose(in);
    return st;
}
