/* The audit log: shown, signed, exported, trimmed.  Its verification is in ctl_review.c. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sodium.h>

#include "audit.h"
#include "json.h"
#include "ctl_command.h"
#include "ctl_model.h"
#include "ctl_token.h"

#define SHOWN 100 /* entries without --limit */

static const char *about, *uid, *kind;    /* --subject, --uid, --kind */
static const char *actor, *since, *until; /* --actor, --since, --until */
static uint32_t limit, keep;              /* --limit, --keep */

/* ---- show */

static void hex_of(const void *bytes, size_t n, char *out)
{
    (void)sodium_bin2hex(out, 2 * n + 1, bytes, n);
}

/* Returns the id of the entry's subject, or the beginning of the uid of a subject that was erased. */
static const char *who(const struct store_audit_entry *a, char out[16])
{
    char hex[2 * LOG_UID + 1];

    if (a->subject[0] != '\0' || sodium_is_zero(a->entry.uid, sizeof a->entry.uid))
        return a->subject;
    hex_of(a->entry.uid, sizeof a->entry.uid, hex);
    (void)snprintf(out, 16, "#%.12s", hex);
    return out;
}

static void show_entry(struct ctl *c, const struct store_audit_entry *a)
{
    const struct log_entry *entry = &a->entry;
    char name[16], log[24], by[CTL_TOKEN_LABEL];

    (void)snprintf(log, sizeof log, entry->daemon > 0 ? "%s/%" PRIu32 : "%s",
                   log_word(entry->log), entry->daemon);
    ctl_token_label(by, a->actor_name, entry->actor);
    json_object(c->out, NULL);
    audit_describe(c->out, a);
    json_close(c->out);
    ctl_say(c, "%-10s %8" PRIu64 "  %.10s %.12s  %-15s  %-16s  %-32.32s  %-12s  %s\n",
            log, entry->seq, entry->at, entry->at + 11, entry->kind, who(a, name),
            entry->object, entry->outcome, by);
}

static enum status ctl_run_audit_show(struct ctl *c)
{
    unsigned char bytes[LOG_UID];
    struct store_audit_filter wanted = {.subject = about,
                                        .kind = kind,
                                        .actor = actor,
                                        .since = since,
                                        .until = until,
                                        .newest = true,
                                        .names = true,
                                        .limit = limit != 0 ? limit : SHOWN};
    struct store_audit_entry *a = NULL;
    char token[STORE_ID_LEN + 1];
    size_t n = 0, got = 0;
    enum status st;

    if (actor != NULL && (st = ctl_token_find(c, actor, true, token)) == ST_OK)
        wanted.actor = token;
    else if (actor != NULL && st != ST_ENOTFOUND) /* else it is a program */
        return st;
    if (uid != NULL) {
        if (about != NULL ||
            sodium_hex2bin(bytes, sizeof bytes, uid, strlen(uid), NULL, &got, NULL) !=
                0 ||
            got != sizeof bytes)
            return ctl_usage(c, "--uid takes 32 hexadecimal digits, and no --subject");
        wanted.uid = bytes;
    }
    if ((st = store_audit_list(c->store, &wanted, &a, &n, NULL, &c->e)) != ST_OK)
        return st;
    json_array(c->out, "entries");
    if (n > 0)
        ctl_say(c, "%-10s %8s  %-23s  %-15s  %-16s  %-32s  %-12s  %s\n", "LOG", "ENTRY",
                "TIME (UTC)", "KIND", "SUBJECT", "OBJECT", "OUTCOME", "ACTOR");
    for (size_t i = n; i > 0; i--) /* oldest first */
        show_entry(c, &a[i - 1]);
    json_close(c->out);
    if (n == 0)
        ctl_say(c, "no entries\n");
    free(a);
    return ST_OK;
}

/* ---- checkpoint */

static enum status checkpoint(struct ctl *c)
{
    struct log_entry entry;
    char hash[2 * LOG_HASH + 1], signature[2 * CRYPT_SIGN + 1], key[2 * CRYPT_KEY + 1];
    const enum status st =
        store_audit_sign(c->store, c->actor, LOG_CHECKPOINT, &entry, NULL, &c->e);

    if (st != ST_OK)
        return st;
    hex_of(entry.hash, LOG_HASH, hash);
    hex_of(entry.signature, sizeof entry.signature, signature);
    store_audit_public(c->store, key);
    json_number(c->out, "checkpoint", (double)entry.seq);
    json_text(c->out, "at", entry.at);
    json_text(c->out, "hash", hash);
    json_text(c->out, "signature", signature);
    json_text(c->out, "public_key", key);
    ctl_say(c,
            "change      %" PRIu64 " of %s\n"
            "hash        %s\n"
            "signature   %s\n"
            "public key  %s\n",
            entry.seq, entry.at, hash, signature, key);
    return ST_OK;
}

/* ---- export */

static enum status export_log(struct ctl *c)
{
    struct audit_export x;
    enum status st;

    if (c->dir == NULL)
        c->dir = "-";
    if ((st = ctl_may_pipe(c, 0)) != ST_OK ||
        (st = ctl_model_open(c, STORE_WRITE)) != ST_OK ||
        (st = audit_export_begin(c->store, c->actor, &x, &c->e)) != ST_OK ||
        (st = ctl_write(c, c->dir, audit_export_lines, &x)) != ST_OK)
        return st;
    json_text(c->out, "file", c->dir);
    json_number(c->out, "changes", (double)x.end.seq);
    json_text(c->out, "public_key", x.public_key);
    ctl_say(c, "%" PRIu64 " change%s, and the accesses; public key %s\n",
            CTL_COUNT(x.end.seq), x.public_key);
    return ST_OK;
}

/* ---- compare */

static enum status ctl_run_audit_compare(struct ctl *c)
{
    unsigned differ = 0;
    enum status st = ST_OK;

    json_array(c->out, "anchors");
    for (int i = 0; i < c->nargs && st == ST_OK; i++) {
        struct log_end at;
        uint32_t daemon;
        bool has;

        st = store_audit_anchor(c->store, c->args[i], &daemon, &at, &has, &c->e);
        if (st != ST_OK)
            break;
        differ += !has;
        json_object(c->out, NULL);
        json_text(c->out, "anchor", c->args[i]);
        json_number(c->out, "daemon", daemon);
        json_number(c->out, "change", (double)at.seq);
        json_flag(c->out, "in_log", has);
        json_close(c->out);
        ctl_say(
            c, "%s: daemon %" PRIu32 ", change %" PRIu64 ": %s\n", c->args[i], daemon,
            at.seq,
            has ? "in the log"
                : "NOT in the log: the daemon has read another history of the database");
    }
    json_close(c->out);
    json_flag(c->out, "ok", differ == 0);
    c->code = differ == 0 ? EXIT_FINE : EXIT_NO;
    return st;
}

/* ---- trim */

static enum status trim(struct ctl *c)
{
    uint64_t cut = 0;
    enum status st;

    if (keep == 0)
        return ctl_usage(c, "audit trim needs --keep DAYS");
    st = store_audit_trim(c->store, c->actor, keep, c->dry_run, &cut, &c->e);
    if (st != ST_OK)
        return st;
    json_number(c->out, "cut", (double)cut);
    json_flag(c->out, "dry_run", c->dry_run);
    ctl_say(c, "%" PRIu64 " access%s older than %" PRIu64 " day%s%s\n", cut,
            cut == 1 ? "" : "es", CTL_COUNT((uint64_t)keep),
            c->dry_run ? "" : ": deleted");
    return ST_OK;
}

/* ---- the commands */

const struct ctl_command ctl_audit_show = {
    .name = "audit show",
    .database = CTL_READS_DATABASE,
    .options = {CTL_OPTION("subject", "ID", command_text, &about,
                           "only entries about this subject"),
                CTL_OPTION(
                    "uid", "UID", command_text, &uid,
                    "only entries about the subject with this uid, as its receipt\n"
                    "names it, erased or not"),
                CTL_OPTION("kind", "WORD", command_text, &kind,
                           "only entries of this kind, or these: enroll,verify"),
                CTL_OPTION("actor", "NAME", command_text, &actor,
                           "only what this token (its name or id) or program did"),
                CTL_OPTION("since", "TIME", command_text, &since,
                           "only entries since 2026-11-21 or 2026-11-21T14:30 (UTC)"),
                CTL_OPTION("until", "TIME", command_text, &until,
                           "only entries up to then, that day or minute included"),
                CTL_OPTION("limit", "N", command_whole, &limit, "the newest N (100)")},
    .run = ctl_run_audit_show,
    .summary = "list who did what, and when",
    .help =
        "The newest entries, oldest first. The actor is a token, named with the beginning of\n"
        "its id, a program, or surfacectl:USER. A subject has a random uid, which the receipt\n"
        "of its erasure names.",
    .example = "surfacectl --db faces.db audit show --subject alice --since 2026-11-01"};

const struct ctl_command ctl_audit_export = {
    .name = "audit export",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_OUT | CTL_FORCE,
    .run = export_log,
    .summary = "write the audit log as signed JSON lines",
    .help = "To --out, or standard output (-). Random uids replace the subjects' ids.",
    .example = "surfacectl --db faces.db audit export --out log.jsonl"};

const struct ctl_command ctl_audit_checkpoint = {
    .name = "audit checkpoint",
    .database = CTL_WRITES_DATABASE,
    .run = checkpoint,
    .summary = "sign the audit log as it is now",
    .help = "Keep the output elsewhere: it reveals later that an older log was put back.",
    .example = "surfacectl --db faces.db --json audit checkpoint"};

const struct ctl_command ctl_audit_trim = {
    .name = "audit trim",
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_DRY_RUN,
    .options = {CTL_OPTION("keep", "DAYS", command_whole, &keep,
                           "how long entries are kept")},
    .run = trim,
    .summary = "delete the oldest accesses from the audit log",
    .help =
        "Accesses (verifications, comparisons, refusals, exports) older than --keep days are\n"
        "deleted; changes never. The setting audit-days makes surfaced do this.",
    .example = "surfacectl --db faces.db audit trim --keep 400"};

const struct ctl_command ctl_audit_compare = {
    .name = "audit compare",
    .args = "ANCHOR...",
    .takes = {1, CTL_MANY},
    .database = CTL_READS_DATABASE,
    .exits = {"the log has what every anchor names", "it has not"},
    .run = ctl_run_audit_compare,
    .summary = "hold the anchors of other daemons against the log",
    .help =
        "The anchors are copies from the daemons that share a database on a server. A change that\n"
        "the log lacks belongs to another history, or the server was rolled back.",
    .example =
        "surfacectl --db postgresql://surfaced@db1/faces audit compare door1.anchor "
        "door2.anchor"};
