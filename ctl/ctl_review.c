/* Files that the database signed, verified: exports of the audit log, receipts of erasures. */
#include "ctl_review.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl_command.h"
#include "ctl_config.h"
#include "ctl_model.h"
#include "readfile.h"
#include "json.h"
#include "store.h"

#define LINE          4096      /* bytes of a line of an export, at most */
#define FILE_MAX      (1 << 20) /* bytes: some 25,000 templates */
#define TEMPLATES_MAX 100000

/* A line as a document; NULL: it is none. */
static struct json_value *ctl_review_read_line(const char *line)
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
static bool walk_line(struct log_walk *w, const struct ctl_review *how,
                      const struct json_value *v)
{
    struct log_entry entry = {.seq = 0};
    char word[16];
    uint64_t daemon;
    size_t n;

    if (!take_text(v, "log", word, sizeof word))
        return false;
    if (strcmp(word, log_word(LOG_ACCESSES)) == 0)
        entry.log = LOG_ACCESSES;
    else if (strcmp(word, log_word(LOG_CHANGES)) != 0 || w->log == LOG_ACCESSES)
        return false;
    if (!json_get_count(json_member(v, "daemon"), &daemon) || daemon >= LOG_DAEMONS ||
        !json_get_count(json_member(v, "seq"), &entry.seq) ||
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
    entry.daemon = (uint32_t)daemon;
    if (entry.log != w->log)
        log_walk_accesses(w);
    log_walk_step(w, &entry);
    if (entry.log == LOG_CHANGES && how->change != NULL)
        how->change(how->arg, &entry);
    return true;
}

/* The first line: it must be of this format. */
static enum status walk_head(struct ctl *c, FILE *in)
{
    char line[LINE];
    uint64_t version = 0;
    struct json_value *v = NULL;
    enum status st = ST_OK;

    if (fgets(line, sizeof line, in) == NULL ||
        (v = ctl_review_read_line(line)) == NULL ||
        !json_get_count(json_member(v, "surface_audit"), &version))
        st = errinfo_set(&c->e, ST_EINVAL, "%.120s is not an audit log", c->args[0]);
    else if (version != 2)
        st = errinfo_set(&c->e, ST_EVERSION, "%.120s is of another version", c->args[0]);
    json_free(v);
    return st;
}

static enum status walk_file(struct ctl *c, FILE *in, const struct ctl_review *how,
                             struct log_walk *w)
{
    char line[LINE], text[80];
    uint64_t changes = 0;
    const enum status st = walk_head(c, in);

    if (st != ST_OK)
        return st;
    for (unsigned long n = 2; fgets(line, sizeof line, in) != NULL; n++) {
        struct json_value *v = ctl_review_read_line(line);

        if (v == NULL || !walk_line(w, how, v)) {
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

enum status ctl_review_file(struct ctl *c, const struct ctl_review *how,
                            struct log_walk *out)
{
    unsigned char public[CRYPT_KEY] = {0};
    size_t n = 0;
    FILE *in;
    enum status st;

    log_walk_begin(out, NULL, public, how->report, c);
    if (sodium_hex2bin(public, sizeof public, c->public_key, strlen(c->public_key), NULL,
                       &n, NULL) != 0 ||
        n != sizeof public)
        return errinfo_set(&c->e, ST_EINVAL, "a public key is 64 hexadecimal digits");
    if ((in = fopen(c->args[0], "rb")) == NULL)
        return errinfo_set(&c->e, ST_ENOTFOUND, "there is no file %.120s", c->args[0]);
    log_walk_begin(out, NULL, public, how->report, c);
    st = walk_file(c, in, how, out);
    (void)fclose(in);
    return st;
}

/* ---- a receipt */

struct review {
    struct ctl *c;
    struct store_receipt r;
    unsigned problems;
};

static void problem(struct review *v, const char *text)
{
    v->problems++;
    json_text(v->c->out, NULL, text);
    ctl_say(v->c, "%s\n", text);
}

/* ---- the file: as the response to DELETE over HTTP, or subject erase --json */

static bool read_templates(const struct json_value *ids, struct store_receipt *r)
{
    const struct json_value *v = json_first(ids);

    r->template_id = calloc(TEMPLATES_MAX, sizeof *r->template_id);
    if (!json_is_array(ids) || r->template_id == NULL)
        return false;
    for (; v != NULL; v = json_next(v), r->templates++)
        if (r->templates == TEMPLATES_MAX ||
            !json_copy_text(v, r->template_id[r->templates], sizeof *r->template_id))
            return false;
    return true;
}

static bool take_receipt(const struct json_value *v, struct store_receipt *r)
{
    const struct json_value *audit = json_member(v, "audit");

    return take_text(v, "subject", r->subject, sizeof r->subject) &&
           ident_subject_valid(r->subject) &&
           take_text(v, "subject_uid", r->uid, sizeof r->uid) &&
           take_text(v, "erased_at", r->at, sizeof r->at) &&
           take_text(v, "digest", r->digest, sizeof r->digest) &&
           take_text(v, "signature", r->signature, sizeof r->signature) &&
           take_text(v, "public_key", r->public_key, sizeof r->public_key) &&
           read_templates(json_member(v, "template_ids"), r) &&
           json_get_count(json_member(audit, "seq"), &r->seq) && r->seq > 0 &&
           take_text(audit, "hash", r->hash, sizeof r->hash);
}

static enum status read_receipt(struct review *v)
{
    struct json_value *doc = NULL;
    unsigned char *text;
    size_t len;
    enum status st = readfile_all(v->c->args[0], FILE_MAX, &text, &len, &v->c->e);

    if (st == ST_OK && (json_read((char *)text, len, TEMPLATES_MAX + JSON_MEMBERS, &doc,
                                  NULL) != ST_OK ||
                        !take_receipt(doc, &v->r)))
        st = errinfo_set(&v->c->e, ST_EINVAL, "%.160s is not a receipt", v->c->args[0]);
    json_free(doc);
    free(text);
    return st;
}

/* ---- the database that is said to have given it */

/* The hash is of the whole log up to there: the entry is of this database, whatever key signed the
 * receipt. */
static enum status look_at_log(struct review *v)
{
    struct log_end at = {.seq = v->r.seq};
    bool has = false;
    enum status st = ST_OK;

    if (sodium_hex2bin(at.hash, sizeof at.hash, v->r.hash, strlen(v->r.hash), NULL, NULL,
                       NULL) == 0)
        st = store_audit_has(v->c->store, &at, &has, &v->c->e);
    if (st == ST_OK && !has)
        problem(
            v,
            "the change log lacks this entry: the receipt is from another database, or "
            "the log was replaced by an older one");
    return st;
}

static enum status look_at_templates(struct review *v)
{
    struct store_template t;
    enum status st = ST_OK;

    for (uint32_t i = 0; st == ST_OK && i < v->r.templates; i++) {
        st = store_template_get(v->c->store, v->r.template_id[i], &t, &v->c->e);
        if (st == ST_OK)
            problem(v, "a template named by the receipt exists");
        else if (st == ST_ENOTFOUND || st == ST_EINVAL)
            st = ST_OK;
    }
    return st;
}

static enum status ask_database(struct review *v)
{
    enum status st = ctl_model_open(v->c, STORE_READ);

    if (st == ST_OK && (st = look_at_log(v)) == ST_OK)
        st = look_at_templates(v);
    return st;
}

static enum status ctl_review_run(struct ctl *c)
{
    struct review v = {.c = c};
    enum status st;

    if (c->public_key == NULL && c->db == NULL && ctl_config_database(c, false) != ST_OK)
        return ST_EINVAL;
    st = read_receipt(&v);
    json_array(c->out, "problems");
    if (st == ST_OK && !store_receipt_true(&v.r))
        problem(&v, "its contents differ from what was signed");
    if (st == ST_OK && c->public_key != NULL &&
        strcmp(c->public_key, v.r.public_key) != 0)
        problem(&v, "it was signed by a key other than the one given");
    if (st == ST_OK && c->db != NULL)
        st = ask_database(&v);
    json_close(c->out);
    if (st == ST_OK) {
        json_flag(c->out, "ok", v.problems == 0);
        json_text(c->out, "subject", v.r.subject);
        json_text(c->out, "erased_at", v.r.at);
        json_number(c->out, "templates_removed", v.r.templates);
        json_object(c->out, "audit");
        json_number(c->out, "seq", (double)v.r.seq);
        json_close(c->out);
        ctl_say(c, "%s: %s with %u template%s, at %s, entry %" PRIu64 "\n",
                v.problems == 0 ? "ok" : "NOT ok", v.r.subject, v.r.templates,
                v.r.templates == 1 ? "" : "s", v.r.at, v.r.seq);
    }
    store_receipt_free(&v.r);
    c->code = v.problems == 0 ? EXIT_FINE : EXIT_NO;
    return st;
}

const struct ctl_command ctl_review_receipt = {
    .name = "audit receipt",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_TAKES_DATABASE,
    .shared = CTL_PUBLIC_KEY,
    .exits = {"the receipt is valid", "it is not valid; problems are printed"},
    .run = ctl_review_run,
    .summary = "verify the receipt of an erasure",
    .help =
        "FILE is the response to DELETE over HTTP, or the output of subject erase --json (-:\n"
        "standard input). With --public-key: verifies that this key signed it. With a "
        "database (the\n"
        "default): verifies that its present or an earlier key signed it, that its audit log has\n"
        "the entry, and that none of the templates exists.",
    .example = "surfacectl --db faces.db audit receipt alice.json"};
