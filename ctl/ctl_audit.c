/* The audit log: shown, verified, signed, written to a file that can be verified without the
 * database; and who was erased. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "json.h"
#include "store_chain.h"
#include "ctl_command.h"
#include "ctl_config.h"
#include "ctl_dir.h"
#include "ctl_model.h"
#include "ctl_review.h"

#define SHOWN 100  /* entries without --limit */
#define PAGE  1000 /* read at a time */

static const char *about, *kind, *since; /* --subject, --kind, --since */
static uint32_t limit, keep;             /* --limit, --keep */

/* ---- show */

/* Who it was about: a name, or a part of the hash that stands for one. */
static const char *who(const struct store_audit_entry *a, char out[16])
{
    if (a->subject[0] != '\0' || a->ref[0] == '\0')
        return a->subject;
    (void)snprintf(out, 16, "#%.12s", a->ref);
    return out;
}

static const char *or_null(const char *text)
{
    return text[0] != '\0' ? text : NULL;
}

static void out_entry(struct json *j, const struct store_audit_entry *a)
{
    json_text(j, "chain", store_chain_word(a->chain));
    json_number(j, "seq", (double)a->seq);
    json_text(j, "at", a->at);
    json_text(j, "kind", a->kind);
    json_text(j, "actor", a->actor);
    json_text(j, "subject_ref", or_null(a->ref));
    json_text(j, "template_id", or_null(a->template_id));
    json_text(j, "outcome", a->outcome);
    if (a->chain == STORE_CHAIN_CHANGES) {
        json_text(j, "object", or_null(a->object));
        json_text(j, "row", or_null(a->row));
        json_number(j, "uses", (double)a->uses);
        json_text(j, "uses_hash", a->uses_hash);
    }
    json_text(j, "hash", a->hash);
}

static void show_entry(struct ctl *c, const struct store_audit_entry *a)
{
    char ref[16];

    json_object(c->out, NULL);
    out_entry(c->out, a);
    json_text(c->out, "subject", or_null(a->subject));
    json_close(c->out);
    ctl_say(c, "%-7s %8" PRIu64 "  %.10s %.12s  %-15s  %-16s  %-32s  %-12s  %s\n",
            store_chain_word(a->chain), a->seq, a->at, a->at + 11, a->kind, who(a, ref),
            a->template_id, a->outcome, a->actor);
}

static enum status show(struct ctl *c)
{
    const struct store_audit_filter wanted = {.limit = limit != 0 ? limit : SHOWN,
                                              .newest = true,
                                              .names = true,
                                              .subject = about,
                                              .kind = kind,
                                              .since = since};
    struct store_audit_entry *a = NULL;
    size_t n = 0;
    const enum status st = store_audit_list(c->store, &wanted, &a, &n, &c->e);

    if (st != ST_OK)
        return st;
    json_array(c->out, "entries");
    if (n > 0)
        ctl_say(c, "%-7s %8s  %-23s  %-15s  %-16s  %-32s  %-12s  %s\n", "CHAIN", "ENTRY",
                "TIME (UTC)", "KIND", "SUBJECT", "TEMPLATE", "OUTCOME", "ACTOR");
    for (size_t i = 0; i < n; i++)
        show_entry(c, &a[i]);
    json_close(c->out);
    if (n == 0)
        ctl_say(c, "no entries\n");
    free(a);
    return ST_OK;
}

/* ---- checkpoint */

static void out_mark(struct json *o, const struct store_audit_mark *m)
{
    json_text(o, "chain", store_chain_word(m->chain));
    json_number(o, "checkpoint", (double)m->seq);
    json_text(o, "at", m->at);
    json_text(o, "hash", m->hash);
    json_text(o, "signature", m->signature);
}

static enum status checkpoint(struct ctl *c)
{
    struct store_audit_mark m;
    char public_key[65];
    enum status st = store_audit_public(c->store, public_key, &c->e);

    if (st != ST_OK ||
        (st = store_audit_sign(c->store, c->actor, STORE_CHAIN_SIGN, &m, &c->e)) != ST_OK)
        return st;
    out_mark(c->out, &m);
    json_text(c->out, "public_key", public_key);
    ctl_say(c,
            "change      %" PRIu64 " of %s\nhash        %s\nsignature   %s\n"
            "public key  %s\n",
            m.seq, m.at, m.hash, m.signature, public_key);
    return ST_OK;
}

/* ---- export */

struct export
{
    struct store *store;
    struct store_audit_mark end, *marks;
    size_t nmark, next; /* of the marks, the one to be written */
    uint64_t uses;      /* the last of them when the end was signed */
    char public_key[65];
};

/* The document on a line of its own; it is released. */
static enum status put_line(FILE *to, struct json *j, struct errinfo *e)
{
    return ctl_print(to, json_compact(j))
               ? ST_OK
               : errinfo_set(e, ST_EIO, "the audit log cannot be written");
}

static enum status put_head(FILE *to, const struct export *x, struct errinfo *e)
{
    struct json *j = json_new();

    json_number(j, "surface_audit", 1);
    json_text(j, "public_key", x->public_key);
    json_text(j, "at", x->end.at);
    json_number(j, "changes", (double)x->end.seq);
    return put_line(to, j, e);
}

/* The entries and behind each the mark that it has. */
static enum status put_page(FILE *to, struct export *x, const struct store_audit_entry *a,
                            size_t n, struct errinfo *e)
{
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < n; i++) {
        struct json *j = json_new();

        out_entry(j, &a[i]);
        st = put_line(to, j, e);
        while (st == ST_OK && x->next < x->nmark &&
               (x->marks[x->next].chain < a[i].chain ||
                (x->marks[x->next].chain == a[i].chain &&
                 x->marks[x->next].seq <= a[i].seq))) {
            j = json_new();
            out_mark(j, &x->marks[x->next++]);
            st = put_line(to, j, e);
        }
        if (a[i].chain == STORE_CHAIN_CHANGES)
            x->uses = a[i].uses;
    }
    return st;
}

/* One after the other, up to the entry `last`. */
static enum status put_chain(FILE *to, struct export *x, enum store_chain chain,
                             uint64_t last, struct errinfo *e)
{
    struct store_audit_filter wanted = {.chain = &chain, .limit = PAGE};
    struct store_audit_entry *a;
    enum status st = ST_OK;
    size_t n;

    while (st == ST_OK && wanted.after < last) {
        if ((st = store_audit_list(x->store, &wanted, &a, &n, e)) != ST_OK)
            return st;
        while (n > 0 && a[n - 1].seq > last) /* of after it was signed */
            n--;
        wanted.after = n > 0 ? a[n - 1].seq : last;
        st = put_page(to, x, a, n, e);
        free(a);
    }
    return st;
}

/* The log as it is, sound or not: whoever verifies the file finds what is wrong. */
static enum status put_log(FILE *to, const void *arg, struct errinfo *e)
{
    struct export x = *(const struct export *)arg;
    enum status st = put_head(to, &x, e);

    if (st == ST_OK)
        st = put_chain(to, &x, STORE_CHAIN_CHANGES, x.end.seq, e);
    return st == ST_OK ? put_chain(to, &x, STORE_CHAIN_USES, x.uses, e) : st;
}

static enum status export_log(struct ctl *c)
{
    struct export x = {.nmark = 0};
    enum status st;

    if (c->dir == NULL)
        c->dir = "-";
    if ((st = ctl_dir_may_pipe(c, 0)) != ST_OK)
        return st;
    if ((st = ctl_model_open(c, STORE_WRITE)) == ST_OK &&
        (st = store_audit_public(c->store, x.public_key, &c->e)) == ST_OK &&
        (st = store_audit_sign(c->store, c->actor, STORE_CHAIN_EXPORT, &x.end, &c->e)) ==
            ST_OK &&
        (st = store_audit_marks(c->store, &x.marks, &x.nmark, &c->e)) == ST_OK) {
        x.store = c->store;
        st = ctl_dir_file(c, c->dir, put_log, &x);
    }
    free(x.marks);
    if (st != ST_OK)
        return st;
    json_text(c->out, "file", c->dir);
    json_number(c->out, "changes", (double)x.end.seq);
    json_text(c->out, "public_key", x.public_key);
    ctl_say(c, "%" PRIu64 " change%s, and the uses; public key %s\n",
            CTL_COUNT(x.end.seq), x.public_key);
    return ST_OK;
}

/* ---- verify */

static void tell_problem(void *arg, enum store_chain chain, uint64_t seq,
                         const char *line)
{
    struct ctl *c = arg;

    json_object(c->out, NULL);
    json_text(c->out, "chain", store_chain_word(chain));
    json_number(c->out, "entry", (double)seq);
    json_text(c->out, "problem", line);
    json_close(c->out);
    ctl_say(c, "%s, at entry %" PRIu64 ": %s\n", store_chain_word(chain), seq, line);
}

static enum status verify_database(struct ctl *c, struct store_audit *out,
                                   char public_key[65])
{
    enum status st;

    if ((st = ctl_model_open(c, STORE_READ)) == ST_OK &&
        (st = store_audit_public(c->store, public_key, &c->e)) == ST_OK)
        st = store_audit_verify(c->store, tell_problem, c, out, &c->e);
    return st;
}

static enum status verify(struct ctl *c)
{
    struct store_audit found;
    char public_key[65] = "";
    enum status st;

    if ((c->nargs > 0) != (c->public_key != NULL))
        return ctl_usage(c, "a file is verified by --public-key, a database without");
    if (c->nargs == 0 && c->db == NULL && ctl_config_database(c, false) != ST_OK)
        return ST_EINVAL;
    json_array(c->out, "problems");
    st = c->nargs > 0 ? ctl_review_file(c, tell_problem, &found)
                      : verify_database(c, &found, public_key);
    json_close(c->out);
    if (st != ST_OK)
        return st;
    c->code = found.problems == 0 ? EXIT_FINE : EXIT_NO;
    json_flag(c->out, "ok", found.problems == 0);
    json_number(c->out, "entries", (double)found.entries);
    json_number(c->out, "checkpoints", (double)found.checkpoints);
    json_text(c->out, "public_key", public_key[0] != '\0' ? public_key : NULL);
    json_text(c->out, "first_chain",
              found.problems > 0 ? store_chain_word(found.chain) : NULL);
    json_number(c->out, "first_entry",
                found.problems > 0 ? (double)found.first : (double)NAN);
    ctl_say(c,
            "%s: %" PRIu64 " entr%s, %" PRIu64 " checkpoint%s, %" PRIu64
            " problem%s%s%s\n",
            found.problems == 0 ? "ok" : "NOT ok", found.entries,
            found.entries == 1 ? "y" : "ies", CTL_COUNT(found.checkpoints),
            CTL_COUNT(found.problems), public_key[0] != '\0' ? "; public key " : "",
            public_key);
    return ST_OK;
}

/* ---- trim */

static enum status trim(struct ctl *c)
{
    uint64_t cut = 0;
    enum status st;

    if (keep == 0)
        return ctl_usage(c, "--keep DAYS is missing");
    st = store_audit_trim(c->store, c->actor, keep, c->dry_run, &cut, &c->e);
    if (st != ST_OK)
        return st;
    json_number(c->out, "cut", (double)cut);
    json_flag(c->out, "dry_run", c->dry_run);
    ctl_say(c, "%" PRIu64 " use%s older than %" PRIu64 " day%s%s\n", CTL_COUNT(cut),
            CTL_COUNT(keep), c->dry_run ? "" : ": cut off");
    return ST_OK;
}

/* ---- erased */

static enum status erased(struct ctl *c)
{
    const char *subject = c->nargs > 0 ? c->args[0] : NULL;
    struct store_erased *list = NULL;
    size_t n = 0;
    enum status st = store_audit_erased(c->store, subject, &list, &n, &c->e);

    if (st != ST_OK)
        return st;
    json_array(c->out, "erased");
    for (size_t i = 0; i < n; i++) {
        json_object(c->out, NULL);
        json_text(c->out, "erased_at", list[i].at);
        json_text(c->out, "subject_ref", or_null(list[i].ref));
        json_close(c->out);
        ctl_say(c, "%s  #%s\n", list[i].at, list[i].ref);
    }
    json_close(c->out);
    if (n == 0)
        ctl_say(c, "%s\n", subject == NULL ? "no subject was erased" : "not erased");
    free(list);
    c->code = subject != NULL && n == 0 ? EXIT_NO : EXIT_FINE;
    return ST_OK;
}

/* ---- the commands */

const struct ctl_command ctl_audit_show = {
    .name = "audit show",
    .database = CTL_READS_DATABASE,
    .options = {CTL_OPTION("subject", "ID", ctl_option_text, &about,
                           "only entries about this subject, erased or not"),
                CTL_OPTION("kind", "WORD", ctl_option_text, &kind,
                           "only entries of this kind, like enroll or verify"),
                CTL_OPTION("since", "TIME", ctl_option_text, &since,
                           "only entries from 2026-11-21, or 2026-11-21T14:30, on (UTC)"),
                CTL_OPTION("limit", "N", ctl_option_whole, &limit, "the newest N (100)")},
    .run = show,
    .summary = "list who did what, and when",
    .help =
        "The newest entries of the audit log, oldest first.  The actor is a token's id, a\n"
        "program, or surfacectl:USER.  Erased subjects have no name in the log, but --subject\n"
        "finds their entries; of a subject that was renamed it also finds those under its former\n"
        "ids.",
    .example = "surfacectl --db faces.db audit show --subject alice --since 2026-11-01"};

const struct ctl_command ctl_audit_verify = {
    .name = "audit verify",
    .args = "[FILE]",
    .takes = {0, 1},
    .database = CTL_TAKES_DATABASE,
    .shared = CTL_PUBLIC_KEY,
    .exits = {"the log is as it was written", "it is not: each problem is printed"},
    .run = verify,
    .summary = "find audit entries that were removed or changed",
    .help =
        "In the database; or, with --public-key and without a database, in a FILE that audit\n"
        "export wrote.",
    .example = "surfacectl audit verify log.jsonl --public-key "
               "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025"};

const struct ctl_command ctl_audit_export = {
    .name = "audit export",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_OUT | CTL_FORCE,
    .run = export_log,
    .summary = "write the audit log as signed JSON lines",
    .help =
        "To --out, or standard output (-).  It has a keyed hash in place of each subject's id.",
    .example = "surfacectl --db faces.db audit export --out log.jsonl"};

const struct ctl_command ctl_audit_checkpoint = {
    .name = "audit checkpoint",
    .database = CTL_WRITES_DATABASE,
    .run = checkpoint,
    .summary = "sign the audit log as it is now",
    .help =
        "Keep the output elsewhere: with it, an older log that was put back can be recognised.",
    .example = "surfacectl --db faces.db --json audit checkpoint"};

const struct ctl_command ctl_audit_trim = {
    .name = "audit trim",
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_DRY_RUN,
    .options = {CTL_OPTION("keep", "DAYS", ctl_option_whole, &keep,
                           "how long entries are kept")},
    .run = trim,
    .summary = "cut off the oldest verifications of the audit log",
    .help =
        "Entries of uses (verifications, comparisons, refusals, exports) that are older than\n"
        "--keep.  Changes are kept for ever; one of them says where the uses begin now, so that\n"
        "audit verify finds every other loss.  surfaced does it by itself: audit-days.",
    .example = "surfacectl --db faces.db audit trim --keep 400"};

const struct ctl_command ctl_audit_erased = {
    .name = "audit erased",
    .args = "[SUBJECT]",
    .takes = {0, 1},
    .database = CTL_READS_DATABASE,
    .exits = {"done", "SUBJECT was not erased, or was enrolled again"},
    .run = erased,
    .summary = "list when subjects were erased",
    .help = "All of them, or SUBJECT alone.",
    .example = "surfacectl --db faces.db audit erased alice"};
