/* export and import: subjects between databases. */
#include <inttypes.h>
#include <stdio.h>

#include "admin_archive.h"
#include "crypt_file.h"
#include "ctl_command.h"
#include "ctl_model.h"

static bool all;   /* --all */
static bool force; /* --force of import */

static enum status export_subjects(struct ctl *c)
{
    char size[32];
    struct admin_copied x;
    struct crypt_file *k = NULL;
    enum status st;

    if (c->dir == NULL || all == (c->nargs > 0))
        return ctl_usage(c, "export needs %s",
                         c->dir == NULL ? "--out FILE" : "ids of subjects, or --all");
    if ((st = ctl_may_write(c, c->dir, 0)) == ST_OK &&
        (st = ctl_model_open(c, STORE_WRITE)) == ST_OK &&
        (st = ctl_model_archive_key(c, true, &k)) == ST_OK)
        st = admin_export(c->store, c->actor, c->args, (size_t)c->nargs, c->dir, k,
                          c->force, &x, &c->e);
    crypt_file_free(k);
    if (st != ST_OK)
        return st;
    json_text(c->out, "archive", c->dir);
    json_number(c->out, "subjects", (double)x.subjects);
    json_number(c->out, "templates", (double)x.templates);
    json_number(c->out, "bytes", (double)x.bytes);
    ctl_say(c, "%s: %" PRIu64 " subject%s, %" PRIu64 " template%s, %s\n", c->dir,
            CTL_COUNT(x.subjects), CTL_COUNT(x.templates), ctl_bytes(x.bytes, size));
    return ST_OK;
}

/* Writes with --dry-run too, and rolls back. */
static enum status import_subjects(struct ctl *c)
{
    struct admin_imported m;
    struct crypt_file *k = NULL;
    enum status st;

    if ((st = ctl_model_open(c, STORE_WRITE)) == ST_OK &&
        (st = ctl_model_archive_key(c, false, &k)) == ST_OK)
        st =
            admin_import(c->store, c->actor, c->args[0], k, c->dry_run, force, &m, &c->e);
    crypt_file_free(k);
    if (st != ST_OK)
        return st;
    json_number(c->out, "subjects", (double)m.subjects);
    json_number(c->out, "templates", (double)m.templates);
    json_number(c->out, "subjects_new", (double)m.new_subjects);
    json_number(c->out, "templates_new", (double)m.new_templates);
    json_number(c->out, "subjects_erased", (double)m.erased);
    json_number(c->out, "templates_to_reencode", (double)m.outdated);
    json_flag(c->out, "imported", !c->dry_run);
    ctl_say(c, "%" PRIu64 " subject%s, %" PRIu64 " template%s; new %s: %llu and %llu\n",
            CTL_COUNT(m.subjects), CTL_COUNT(m.templates),
            c->dry_run ? "would be" : "are", (unsigned long long)m.new_subjects,
            (unsigned long long)m.new_templates);
    if (m.erased > 0)
        ctl_say(c, "%" PRIu64 " subject%s erased here before: left out\n",
                CTL_COUNT(m.erased));
    if (m.outdated > 0)
        ctl_say(
            c, "%" PRIu64 " template%s of another engine: surfacectl template reencode\n",
            CTL_COUNT(m.outdated));
    return ST_OK;
}

const struct ctl_command ctl_archive_export = {
    .name = "export",
    .args = "SUBJECT... | --all",
    .takes = {0, CTL_MANY},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_OUT | CTL_SHORT | CTL_ARCHIVE_KEY | CTL_FORCE,
    .options = {CTL_OPTION("all", NULL, command_flag, &all, "every subject")},
    .run = export_subjects,
    .summary = "write subjects to an archive for another machine",
    .help =
        "The file --out is encrypted with a passphrase, which is asked for, or with the line in\n"
        "--archive-key. It contains no tokens, calibrations or logs.",
    .example = "surfacectl --db faces.db export alice bob --out moving.archive"};

const struct ctl_command ctl_archive_import = {
    .name = "import",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_MODEL | CTL_ARCHIVE_KEY | CTL_DRY_RUN,
    .options = {CTL_OPTION("force", NULL, command_flag, &force,
                           "add templates to subjects who are enrolled here")},
    .run = import_subjects,
    .summary = "read subjects from an archive",
    .help =
        "Imports everything or nothing. Existing subjects and templates do not change; a new\n"
        "template of an existing subject is refused without --force, since no import compares\n"
        "faces. Subjects that were erased here are skipped.",
    .example = "surfacectl --db faces.db import moving.archive --dry-run"};
