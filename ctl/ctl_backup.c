/* backup and restore: the database as a whole. */
#include <inttypes.h>

#include "admin_backup.h"
#include "admin_restore.h"
#include "ctl_command.h"
#include "ctl_dir.h"
#include "ctl_key.h"

static const char *backup_key; /* --backup-key */

static void out_copied(struct ctl *c, const struct admin_copied *k)
{
    json_number(c->out, "subjects", (double)k->subjects);
    json_number(c->out, "templates", (double)k->templates);
    json_number(c->out, "events", (double)k->events);
    json_number(c->out, "bytes", (double)k->bytes);
}

static enum status backup(struct ctl *c)
{
    struct admin_copied copied;
    struct store_key key;
    char size[32];
    enum status st = ctl_dir_may_write(c, c->args[0], 0);

    if (st == ST_OK && (st = ctl_key(c, c->db, &key)) == ST_OK &&
        (st = store_open(c->db, STORE_READ, &key, &c->store, &c->e)) == ST_OK)
        st = admin_backup(c->store, c->args[0], &key, &copied, &c->e);
    if (st != ST_OK)
        return st;
    json_text(c->out, "backup", c->args[0]);
    out_copied(c, &copied);
    ctl_say(c, "%s: verified: %" PRIu64 " subject%s, %" PRIu64 " template%s, %s\n",
            c->args[0], CTL_COUNT(copied.subjects), CTL_COUNT(copied.templates),
            ctl_bytes(copied.bytes, size));
    return ST_OK;
}

static void tell_restored(const struct ctl *c, const struct admin_restored *r)
{
    ctl_say(c, "%s: %" PRIu64 " subject%s, %" PRIu64 " template%s", c->args[0],
            CTL_COUNT(r->backup.subjects), CTL_COUNT(r->backup.templates));
    if (r->was_there)
        ctl_say(c,
                "; in its place now: %" PRIu64 " subject%s, %" PRIu64 " template%s\n"
                "%" PRIu64 " subject%s of those are not in the backup\n"
                "%" PRIu64 " subject%s of the backup were erased since and are erased "
                "again\n"
                "%" PRIu64
                " token%s or devices were revoked, rotated or removed since, and are "
                "revoked",
                CTL_COUNT(r->had_subjects), CTL_COUNT(r->had_templates),
                CTL_COUNT(r->lost), CTL_COUNT(r->erased), CTL_COUNT(r->revoked));
    ctl_say(c, "\n");
    if (c->dry_run)
        ctl_say(c, "nothing was changed\n");
    else if (r->was_there)
        ctl_say(c,
                "restored; the database that was there is %s.before-restore: delete "
                "it when all is well\n",
                c->db);
    else
        ctl_say(c, "restored\n");
}

static enum status restore(struct ctl *c)
{
    struct admin_restored r;
    struct store_key key;
    enum status st = ctl_key(c, c->db, &key);

    if (st == ST_OK)
        st = admin_restore(c->db, c->args[0], &key, backup_key, c->actor, c->dry_run, &r,
                           &c->e);
    if (st != ST_OK)
        return st;
    json_object(c->out, "backup");
    out_copied(c, &r.backup);
    json_close(c->out);
    json_number(c->out, "subjects_before", (double)r.had_subjects);
    json_number(c->out, "templates_before", (double)r.had_templates);
    json_number(c->out, "subjects_lost", (double)r.lost);
    json_number(c->out, "subjects_erased", (double)r.erased);
    json_number(c->out, "tokens_revoked", (double)r.revoked);
    json_flag(c->out, "restored", !c->dry_run);
    tell_restored(c, &r);
    return ST_OK;
}

const struct ctl_command ctl_backup = {
    .name = "backup",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_FORCE,
    .run = backup,
    .summary = "copy the database, also while the daemon runs",
    .help =
        "The copy is of one moment.  Before it gets its name it is verified: every page, every\n"
        "subject and template decrypted, the audit log.  FILE is complete or not there; --force\n"
        "replaces an older backup of that name.  The key is not in it.",
    .example = "surfacectl --db faces.db backup faces-monday.db"};

const struct ctl_command ctl_backup_restore = {
    .name = "restore",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_DRY_RUN,
    .options = {CTL_OPTION("backup-key", "FILE", ctl_option_text, &backup_key,
                           "the key that FILE was made under, if it is another")},
    .run = restore,
    .summary = "replace the database by a backup",
    .help =
        "FILE is verified first.  From the present database its log alone is believed, where that\n"
        "is verified and goes on from the backup's: subjects that were erased since are erased\n"
        "again, and tokens that were revoked or rotated since are revoked.  The result opens with\n"
        "the present key, also where the backup was made under another.  The present database is\n"
        "kept as PATH.before-restore.  Stop the daemon first.",
    .example = "surfacectl --db faces.db restore faces-monday.db --dry-run"};
