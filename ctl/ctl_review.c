/* Verification of the audit log: in the database, or in a file that the database signed, which is an
 * export of the log or the receipt of an erasure. */
#include "ctl_review.h"

#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl_command.h"
#include "ctl_model.h"
#include "json.h"
#include "store.h"

#define LINE          4096      /* bytes of a line of an export, at most */
#define FILE_MAX      (1 << 20) /* bytes: some 25,000 templates */
#define TEMPLATES_MAX 100000

/* Reads a line as a JSON document.  Returns NULL if it is none. */
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

/* ---- an export */

/* Reads the first line of a file.  Returns true if it is the head of an export. */
static bool is_export(FILE *in, char line[LINE])
{
    struct json_value *v;
    bool is;

    line[0] = '\0';
    v = fgets(line, LINE, in) != NULL ? ctl_review_read_line(line) : NULL;
    is = json_member(v, "surface_audit") != NULL;
    json_free(v);
    return is;
}

static enum status need_version(struct ctl *c, const char *head)
{
    struct json_value *v = ctl_review_read_line(head);
    uint64_t version = 0;
    const bool known =
        json_get_count(json_member(v, "surface_audit"), &version) && version == 2;

    json_free(v);
    return known
               ? ST_OK
               : errinfo_set(
                     &c->e, ST_EVERSION,
                     "%.120s: an export of another version: use the surfacectl that wrote it",
                     c->args[0]);
}

/* Walks along the lines behind the head. */
static enum status walk_lines(struct ctl *c, FILE *in, const struct ctl_review *how,
                              struct log_walk *w)
{
    char line[LINE], text[80];
    uint64_t changes = 0;

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
        return errinfo_set(&c->e, ST_EIO, "%.120s: the file cannot be read", c->args[0]);
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

/* ---- a receipt: the response to DELETE over HTTP, or the output of subject erase --json */

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
    struct log_entry *entry = &r->entry;

    entry->is_signed = true;
    return take_text(v, "subject", r->subject, sizeof r->subject) &&
           ident_subject_valid(r->subject) &&
           take_bytes(v, "subject_uid", entry->uid, sizeof entry->uid) &&
           take_text(v, "erased_at", entry->at, sizeof entry->at) &&
           take_text(v, "digest", r->digest, sizeof r->digest) &&
           take_bytes(v, "signature", entry->signature, sizeof entry->signature) &&
           take_bytes(v, "public_key", r->public_key, sizeof r->public_key) &&
           read_templates(json_member(v, "template_ids"), r) &&
           json_get_count(json_member(audit, "seq"), &entry->seq) && entry->seq > 0 &&
           take_bytes(audit, "hash", entry->hash, sizeof entry->hash);
}

/* Reads the receipt whose first line was read. */
static enum status read_receipt(struct ctl *c, FILE *in, const char *line,
                                struct store_receipt *r)
{
    const size_t first = strlen(line);
    struct json_value *doc = NULL;
    char *text = malloc(FILE_MAX);
    enum status st = ST_OK;
    size_t n;

    if (text == NULL)
        return errinfo_memory(&c->e);
    memcpy(text, line, first);
    n = first + fread(text + first, 1, FILE_MAX - 1 - first, in);
    text[n] = '\0'; /* as json_read() needs it */
    if (json_read(text, n, TEMPLATES_MAX + JSON_MEMBERS, &doc, NULL) != ST_OK ||
        !take_receipt(doc, r))
        st = errinfo_set(&c->e, ST_EINVAL,
                         "%.120s is neither an export of an audit log nor a receipt",
                         c->args[0]);
    json_free(doc);
    free(text);
    return st;
}

/* Verifies that none of the templates exists. */
static enum status look_for_templates(struct ctl *c, const struct store_receipt *r,
                                      struct log_walk *w)
{
    struct store_template t;
    enum status st = ST_OK;

    for (uint32_t i = 0; st == ST_OK && i < r->templates; i++) {
        st = store_template_get(c->store, c->actor, r->template_id[i], &t, &c->e);
        if (st == ST_OK)
            log_walk_problem(w, r->entry.seq, "a template named by the receipt exists");
        else if (st == ST_ENOTFOUND || st == ST_EINVAL)
            st = ST_OK;
    }
    return st;
}

/* public: the key given; NULL: none. */
static enum status verify_receipt(struct ctl *c, const struct store_receipt *r,
                                  const unsigned char *public, struct log_walk *w)
{
    struct log_end at = {.seq = r->entry.seq};
    bool has = false;
    enum status st;

    if (!store_receipt_true(r))
        log_walk_problem(w, at.seq,
                         "the contents of the receipt differ from what was signed");
    if (public != NULL && memcmp(public, r->public_key, sizeof r->public_key) != 0)
        log_walk_problem(w, at.seq,
                         "the receipt was signed by a key other than the one given");
    if (c->db == NULL || (st = ctl_model_open(c, STORE_READ)) != ST_OK)
        return c->db == NULL ? ST_OK : st;
    /* The entry's hash covers the log before it, so this is its database, whatever key signed. */
    memcpy(at.hash, r->entry.hash, sizeof at.hash);
    if ((st = store_audit_has(c->store, &at, &has, &c->e)) == ST_OK && !has)
        log_walk_problem(
            w, at.seq,
            "the change log lacks this entry: the receipt is from another database, or "
            "the log was replaced by an older one");
    return st == ST_OK ? look_for_templates(c, r, w) : st;
}

/* ---- either */

enum status ctl_review_file(struct ctl *c, const struct ctl_review *how,
                            struct log_walk *out, struct store_receipt *receipt)
{
    const bool stream = strcmp(c->args[0], "-") == 0;
    unsigned char public[CRYPT_KEY] = {0};
    char line[LINE];
    size_t n = 0;
    FILE *in;
    enum status st = ST_OK;

    if (c->public_key != NULL &&
        (sodium_hex2bin(public, sizeof public, c->public_key, strlen(c->public_key), NULL,
                        &n, NULL) != 0 ||
         n != sizeof public))
        return errinfo_set(&c->e, ST_EINVAL, "a public key is 64 hexadecimal digits");
    log_walk_begin(out, NULL, public, how->report, c);
    if ((in = stream ? stdin : fopen(c->args[0], "rb")) == NULL)
        return errinfo_set(&c->e, ST_ENOTFOUND, "%.120s: the file cannot be opened",
                           c->args[0]);
    if (is_export(in, line)) {
        if (c->public_key == NULL)
            st = errinfo_set(&c->e, ST_EINVAL, "an export needs --public-key");
        else if ((st = need_version(c, line)) == ST_OK)
            st = walk_lines(c, in, how, out);
    } else if (receipt == NULL) {
        st = errinfo_set(&c->e, ST_EINVAL, "%.120s is not an audit log", c->args[0]);
    } else if ((st = read_receipt(c, in, line, receipt)) == ST_OK) {
        st = verify_receipt(c, receipt, c->public_key != NULL ? public : NULL, out);
    }
    if (!stream)
        (void)fclose(in);
    return st;
}

/* ---- audit verify */

static void tell_problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct ctl *c = arg;

    json_object(c->out, NULL);
    json_text(c->out, "log", log_word(log));
    json_number(c->out, "entry", (double)seq);
    json_text(c->out, "problem", line);
    json_close(c->out);
    ctl_say(c, "%s, at entry %" PRIu64 ": %s\n", log_word(log), seq, line);
}

static enum status verify_database(struct ctl *c, struct log_walk *out,
                                   char public_key[2 * CRYPT_KEY + 1])
{
    const enum status st = ctl_model_open(c, STORE_READ);

    if (st != ST_OK)
        return st;
    store_audit_public(c->store, public_key);
    return store_audit_verify(c->store, tell_problem, c, out, &c->e);
}

static void tell_receipt(struct ctl *c, const struct store_receipt *r,
                         const char *verdict)
{
    json_text(c->out, "subject", r->subject);
    json_text(c->out, "erased_at", r->entry.at);
    json_number(c->out, "templates_removed", r->templates);
    json_object(c->out, "audit");
    json_number(c->out, "seq", (double)r->entry.seq);
    json_close(c->out);
    ctl_say(c, "%s: %s with %u template%s, at %s, entry %" PRIu64 "\n", verdict,
            r->subject, r->templates, r->templates == 1 ? "" : "s", r->entry.at,
            r->entry.seq);
}

static void tell_logs(struct ctl *c, const struct log_walk *found, const char *public_key,
                      const char *verdict)
{
    json_number(c->out, "entries", (double)found->entries);
    json_number(c->out, "checkpoints", (double)found->checkpoints);
    json_text_or_null(c->out, "public_key", public_key);
    json_text(c->out, "first_log",
              found->problems > 0 ? log_word(found->first_log) : NULL);
    json_number(c->out, "first_entry",
                found->problems > 0 ? (double)found->first : (double)NAN);
    ctl_say(c,
            "%s: %" PRIu64 " entr%s, %" PRIu64 " checkpoint%s, %" PRIu64
            " problem%s%s%s\n",
            verdict, found->entries, found->entries == 1 ? "y" : "ies",
            CTL_COUNT(found->checkpoints), CTL_COUNT(found->problems),
            public_key[0] != '\0' ? "; public key " : "", public_key);
}

static enum status ctl_review_run(struct ctl *c)
{
    const struct ctl_review how = {.report = tell_problem};
    struct store_receipt receipt = {.templates = 0};
    struct log_walk found;
    char public_key[2 * CRYPT_KEY + 1] = "";
    const char *verdict;
    enum status st;

    if (c->nargs == 0 && c->public_key != NULL)
        return ctl_usage(c, "--public-key is for a file");
    json_array(c->out, "problems");
    st = c->nargs > 0 ? ctl_review_file(c, &how, &found, &receipt)
                      : verify_database(c, &found, public_key);
    json_close(c->out);
    if (st == ST_OK) {
        verdict = found.problems == 0 ? "ok" : "NOT ok";
        c->code = found.problems == 0 ? EXIT_FINE : EXIT_NO;
        json_flag(c->out, "ok", found.problems == 0);
        if (receipt.entry.seq != 0)
            tell_receipt(c, &receipt, verdict);
        else
            tell_logs(c, &found, public_key, verdict);
    }
    store_receipt_free(&receipt);
    return st;
}

const struct ctl_command ctl_review_verify = {
    .name = "audit verify",
    .args = "[FILE]",
    .takes = {0, 1},
    .database = CTL_NEEDS_DATABASE,
    .options = {{"public-key", "HEX", command_text, NULL,
                 "the public key of the database that signed FILE",
                 offsetof(struct ctl, public_key), 0}},
    .exits = {"all is as it was written", "it is not; problems are printed"},
    .run = ctl_review_run,
    .summary = "verify the audit log, or a file that the database signed",
    .help =
        "Without FILE: finds entries of the log that were removed or changed. FILE (-: standard\n"
        "input) is an export of the log, which needs --public-key, or the receipt of an erasure.",
    .example = "surfacectl audit verify log.jsonl --public-key "
               "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025"};
