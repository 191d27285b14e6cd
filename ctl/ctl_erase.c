/* subject erase, template delete, purge: deletion of subjects and templates. */
#include <stdio.h>
#include <stdlib.h>

#include "audit.h"
#include "ctl_command.h"

/* What --dry-run prints of a deletion: the number of templates that would be deleted; it
 * fails if the subject is on hold.  what: "deletes ...". */
static enum status would_erase(struct ctl *c, const struct store_subject *one,
                               uint32_t templates, const char *what)
{
    if (one->hold)
        return errinfo_set(&c->e, ST_EHELD, "subject %s is on hold", one->id);
    json_text(c->out, "subject", one->id);
    json_number(c->out, "templates", templates);
    json_flag(c->out, "deleted", false);
    ctl_say(c, "this %s; nothing was changed\n", what);
    return ST_OK;
}

static enum status erase(struct ctl *c)
{
    char what[256];
    struct store_subject one;
    struct store_receipt r;
    enum status st = store_subject_get(c->store, c->actor, c->args[0], &one, &c->e);

    if (st != ST_OK)
        return st;
    (void)snprintf(what, sizeof what, "deletes subject %s with %u template%s", one.id,
                   one.templates, one.templates == 1 ? "" : "s");
    if (c->dry_run)
        return would_erase(c, &one, one.templates, what);
    if ((st = ctl_confirm(c, what, one.id)) != ST_OK)
        return st;
    if ((st = store_subject_erase(c->store, c->actor, one.id, &r, &c->e)) == ST_OK) {
        audit_receipt(c->out, &r);
        ctl_say(c,
                "deleted subject %s with %u template%s, at %s\n"
                "  receipt   %s\n"
                "  audit     entry %llu\n",
                one.id, r.templates, r.templates == 1 ? "" : "s", r.entry.at, r.digest,
                (unsigned long long)r.entry.seq);
    }
    store_receipt_free(&r);
    return st;
}

static enum status erase_template(struct ctl *c)
{
    struct store_subject one;
    struct store_template t;
    char what[256];
    enum status st = store_template_get(c->store, c->actor, c->args[0], &t, &c->e);

    if (st != ST_OK)
        return st;
    (void)snprintf(what, sizeof what, "deletes template %s of %s", t.id, t.subject);
    if (c->dry_run) {
        st = store_subject_get(c->store, c->actor, t.subject, &one, &c->e);
        return st == ST_OK ? would_erase(c, &one, 1, what) : st;
    }
    if ((st = ctl_confirm(c, what, t.id)) != ST_OK ||
        (st = store_template_delete(c->store, c->actor, t.id, &c->e)) != ST_OK)
        return st;
    json_text(c->out, "template_id", t.id);
    json_number(c->out, "templates_removed", 1);
    ctl_say(c, "deleted template %s of %s\n", t.id, t.subject);
    return ST_OK;
}

/* Those that can be erased, or are kept: in the JSON, and as text. */
static void tell_due(struct ctl *c, const char *key, bool hold,
                     const struct store_subject *due, size_t n)
{
    json_array(c->out, key);
    for (size_t i = 0; i < n; i++) {
        if (due[i].hold != hold)
            continue;
        json_text(c->out, NULL, due[i].id);
        ctl_say(c, "%-32s %9u  %.16s  %s\n", due[i].id, due[i].templates, due[i].expires,
                hold ? "on hold: not erased" : "");
    }
    json_close(c->out);
}

static enum status erase_due(struct ctl *c, const struct store_subject *due, size_t n,
                             size_t *erased)
{
    for (size_t i = 0; i < n; i++) {
        enum status st;

        if (due[i].hold)
            continue;
        st = store_subject_purge(c->store, c->actor, due[i].id, &c->e);
        if (st == ST_OK)
            ++*erased;
        else if (st != ST_ENOTFOUND && st != ST_EHELD)
            return st; /* those: changed since they were listed */
    }
    return ST_OK;
}

static enum status erase_all(struct ctl *c, const struct store_subject *due, size_t n)
{
    char what[64], count[32];
    size_t most = 0, erased = 0;
    enum status st;

    for (size_t i = 0; i < n; i++)
        most += !due[i].hold;
    if (n > 0)
        ctl_say(c, "%-32s %9s  %-16s\n", "SUBJECT", "TEMPLATES", "EXPIRED");
    tell_due(c, "due", false, due, n);
    tell_due(c, "kept", true, due, n);
    (void)snprintf(what, sizeof what, "erases %zu subject%s", most, most == 1 ? "" : "s");
    (void)snprintf(count, sizeof count, "%zu", most);
    if (!c->dry_run && most > 0 &&
        ((st = ctl_confirm(c, what, count)) != ST_OK ||
         (st = erase_due(c, due, n, &erased)) != ST_OK))
        return st;
    json_number(c->out, "erased", (double)erased);
    ctl_say(c, "%zu due, %zu on hold, %zu erased\n", most, n - most, erased);
    return ST_OK;
}

/* It verifies although nothing may be due: a subject who is hidden is not due either. */
static enum status purge(struct ctl *c)
{
    struct store_subject *due = NULL;
    size_t n = 0;
    enum status st = store_verify(c->store, NULL, NULL, &c->e);

    if (st == ST_OK && (st = store_subject_due(c->store, &due, &n, &c->e)) == ST_OK)
        st = erase_all(c, due, n);
    free(due);
    return st;
}

const struct ctl_command ctl_erase = {
    .name = "subject erase",
    .args = "SUBJECT",
    .takes = {1, 1},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_DRY_RUN | CTL_YES,
    .run = erase,
    .summary = "delete a subject with all its templates",
    .help =
        "Prints a receipt; with --json in full, with its signature. Type the id again on a\n"
        "terminal, or give --yes.",
    .example = "surfacectl --db faces.db --yes subject erase alice"};

const struct ctl_command ctl_erase_template = {
    .name = "template delete",
    .args = "ID",
    .takes = {1, 1},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_DRY_RUN | CTL_YES,
    .run = erase_template,
    .summary = "delete one template",
    .help = "Type the id again on a terminal, or give --yes.",
    .example =
        "surfacectl --db faces.db template delete 0123456789abcdef0123456789abcdef --yes"};

const struct ctl_command ctl_erase_purge = {
    .name = "purge",
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_DRY_RUN | CTL_YES,
    .run = purge,
    .summary = "erase the subjects that have expired",
    .help =
        "Lists them, and those on hold, which are not erased. Type their number on a terminal, or\n"
        "give --yes.",
    .example = "surfacectl --db faces.db purge --dry-run"};
