/* audit receipt: is the receipt of an erasure true? */
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"
#include "store_audit.h"
#include "store_receipt.h"
#include "ctl_command.h"
#include "ctl_config.h"
#include "ctl_model.h"
#include "readfile.h"

#define FILE_MAX      (1 << 20) /* bytes: some 25,000 templates */
#define TEMPLATES_MAX 100000

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

static bool take_text(const struct json_value *v, const char *key, char *out, size_t size)
{
    return json_copy_text(json_member(v, key), out, size);
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
        st = errinfo_set(&v->c->e, ST_EINVAL, "%.160s is no receipt", v->c->args[0]);
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
            "the change log has another entry in that place, or none: the receipt is of "
            "another database, or the log is an older one");
    return st;
}

static enum status look_at_templates(struct review *v)
{
    struct store_template t;
    enum status st = ST_OK;

    for (uint32_t i = 0; st == ST_OK && i < v->r.templates; i++) {
        st = store_template_get(v->c->store, v->r.template_id[i], &t, &v->c->e);
        if (st == ST_OK)
            problem(v, "a template of it is there");
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

static enum status run(struct ctl *c)
{
    struct review v = {.c = c};
    enum status st;

    if (c->public_key == NULL && c->db == NULL && ctl_config_database(c, false) != ST_OK)
        return ST_EINVAL;
    st = read_receipt(&v);
    json_array(c->out, "problems");
    if (st == ST_OK && !store_receipt_true(&v.r))
        problem(&v, "what it says is not what was signed");
    if (st == ST_OK && c->public_key != NULL &&
        strcmp(c->public_key, v.r.public_key) != 0)
        problem(&v, "it is signed by another key than the one given");
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

const struct ctl_command ctl_receipt = {
    .name = "audit receipt",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_TAKES_DATABASE,
    .shared = CTL_PUBLIC_KEY,
    .exits = {"the receipt is true", "it is not: each problem is printed"},
    .run = run,
    .summary = "verify the receipt of an erasure",
    .help =
        "FILE is the response to DELETE over HTTP, or the output of subject erase --json; - is\n"
        "standard input.  With --public-key: did that key sign it?  With a database, the default:\n"
        "is it signed by its key, or one that it had before, is the entry in its audit log, and is\n"
        "none of the templates there?",
    .example = "surfacectl --db faces.db audit receipt alice.json"};
