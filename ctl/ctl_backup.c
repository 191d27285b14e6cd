/* The database copied, put back, copied under another key. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "admin_rekey.h"
#include "admin_restore.h"
#include "crypt_file.h"
#include "ctl_command.h"
#include "ctl_model.h"
#include "ctl_review.h"

static const char *backup_key; /* --backup-key */

static void out_copied(struct ctl *c, const struct admin_copied *k)
{
    json_number(c->out, "subjects", (double)k->subjects);
    json_number(c->out, "templates", (double)k->templates);
    json_number(c->out, "events", (double)k->events);
    json_number(c->out, "bytes", (double)k->bytes);
}

/* Writes a verified copy of the database to the argument.  what: the member of the result that names it. */
static enum status copy_to(struct ctl *c, const char *what,
                           enum status (*write)(struct store *, const char *,
                                                const struct store_key *,
                                                struct admin_copied *, struct errinfo *))
{
    const char *to = c->args[0];
    struct admin_copied copied;
    struct store_key key;
    char size[32];
    enum status st = ctl_model_key(c, c->db, &key);

    if (st == ST_OK &&
        (st = store_open(c->db, STORE_READ, &key, &c->store, &c->e)) == ST_OK)
        st = write(c->store, to, &key, &copied, &c->e);
    if (st != ST_OK)
        return st;
    json_text(c->out, what, to);
    out_copied(c, &copied);
    ctl_say(c, "%s: verified: %" PRIu64 " subject%s, %" PRIu64 " template%s, %s\n", to,
            CTL_COUNT(copied.subjects), CTL_COUNT(copied.templates),
            ctl_bytes(copied.bytes, size));
    return ST_OK;
}

static enum status backup(struct ctl *c)
{
    const enum status st = ctl_may_write(c, c->args[0], 0);

    return st == ST_OK ? copy_to(c, "backup", admin_backup) : st;
}

static enum status copy(struct ctl *c)
{
    return copy_to(c, "copy", admin_move);
}

static void tell_restored(const struct ctl *c, const struct admin_restored *r)
{
    ctl_say(c, "%s: %" PRIu64 " subject%s, %" PRIu64 " template%s", c->args[0],
            CTL_COUNT(r->backup.subjects), CTL_COUNT(r->backup.templates));
    if (r->was_there)
        ctl_say(
            c,
            "; the present database: %" PRIu64 " subject%s, %" PRIu64 " template%s\n"
            "%" PRIu64 " subject%s of the present database are not in the backup\n"
            "%" PRIu64 " subject%s of the backup were erased since and are erased "
            "again\n"
            "%" PRIu64
            " token%s or devices were revoked, rotated or removed since and are revoked "
            "again",
            CTL_COUNT(r->had_subjects), CTL_COUNT(r->had_templates), CTL_COUNT(r->lost),
            CTL_COUNT(r->erased), CTL_COUNT(r->revoked));
    ctl_say(c, "\n");
    if (r->missed != 0)
        ctl_say(c,
                "change %" PRIu64 " of the anchor is missing in the database and in the "
                "backup: what the missing changes erased, revoked or disabled is back; "
                "receipts name the erased subjects\n",
                r->missed);
    if (r->already)
        ctl_say(c, "the database is this backup, restored by an earlier run, and has not "
                   "changed since: there was nothing left to do\n");
    else if (c->dry_run)
        ctl_say(c, "nothing was changed\n");
    else if (r->was_there)
        ctl_say(
            c,
            "restored; the previous database is %s.before-restore: delete it when you "
            "no longer need it\n",
            c->db);
    else
        ctl_say(c, "restored\n");
}

static enum status ctl_run_backup_restore(struct ctl *c)
{
    struct admin_restored r;
    struct store_key key;
    enum status st = ctl_model_key(c, c->db, &key);

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
    json_number(c->out, "missed_change", (double)r.missed);
    json_flag(c->out, "already", r.already);
    json_flag(c->out, "restored", !c->dry_run);
    tell_restored(c, &r);
    return ST_OK;
}

/* ---- reapply-erasures */

struct later {            /* of an export of the log */
    struct log_end after; /* the end of the database's own log */
    bool has;             /* true: the export has that change */
    bool full;            /* no memory for more */
    uint64_t to;          /* the last one */
    struct log_entry *list;
    size_t n, room;
};

static void take_change(void *arg, const struct log_entry *entry)
{
    struct later *l = arg;

    l->to = entry->seq;
    if (entry->seq == l->after.seq)
        l->has = memcmp(entry->hash, l->after.hash, LOG_HASH) == 0;
    if (entry->seq <= l->after.seq || !admin_again_is(entry) || l->full)
        return;
    if (l->n == l->room) {
        const size_t room = 2 * l->room + 64;
        struct log_entry *more = realloc(l->list, room * sizeof *more);

        if (more == NULL) {
            l->full = true;
            return;
        }
        l->list = more;
        l->room = room;
    }
    l->list[l->n++] = *entry;
}

static void tell_problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct ctl *c = arg;

    ctl_say(c, "%s, at entry %" PRIu64 ": %s\n", log_word(log), seq, line);
}

/* What the file says after the end of the database's log, whose key has signed it. */
static enum status read_later(struct ctl *c, struct later *l)
{
    char public_key[2 * CRYPT_KEY + 1];
    const struct ctl_review how = {tell_problem, take_change, l};
    struct log_walk found;
    enum status st;

    c->anchor = "none"; /* the anchor names a change that the server has lost */
    if ((st = ctl_model_open(c, STORE_READ)) != ST_OK ||
        (st = store_last_change(c->store, &l->after, &c->e)) != ST_OK)
        return st;
    store_audit_public(c->store, public_key);
    c->public_key = public_key;
    st = ctl_review_file(c, &how, &found, NULL);
    c->public_key = NULL;
    if (st != ST_OK)
        return st;
    if (l->full)
        return errinfo_memory(&c->e);
    if (found.problems > 0)
        return errinfo_set(&c->e, ST_EREFUSED,
                           "%.120s: not authentic: the database has signed other entries",
                           c->args[0]);
    return l->has ? ST_OK
                  : errinfo_set(&c->e, ST_EMISMATCH,
                                "%.120s does not contain this database's last change "
                                "(%" PRIu64 "): use a newer export of this database",
                                c->args[0], l->after.seq);
}

static enum status reapply(struct ctl *c)
{
    const char *anchor = c->anchor;
    struct admin_restored r = {.erased = 0};
    struct later l = {.has = false};
    struct store_key key;
    bool already;
    enum status st = ctl_model_key(c, c->db, &key);

    if (st != ST_OK)
        return st;
    already = admin_again_done(c->db, &key, c->dry_run);
    json_flag(c->out, "already", already);
    if (already) {
        ctl_say(c, "nothing was left to do: an earlier run has done it, and nothing has "
                   "changed since\n");
        return ST_OK;
    }
    st = read_later(c, &l);
    store_close(c->store);
    c->store = NULL;
    c->anchor = anchor;
    if (st == ST_OK && (st = ctl_model_key(c, c->db, &key)) == ST_OK)
        st = admin_again(c->db, &key, c->actor,
                         &(struct admin_later){l.after, l.list, l.n}, c->dry_run, &r,
                         &c->e);
    free(l.list);
    if (st != ST_OK)
        return st;
    json_number(c->out, "from_change", (double)l.after.seq);
    json_number(c->out, "to_change", (double)l.to);
    json_number(c->out, "subjects_erased", (double)r.erased);
    json_number(c->out, "tokens_revoked", (double)r.revoked);
    json_flag(c->out, "dry_run", c->dry_run);
    ctl_say(c,
            "changes %" PRIu64 " to %" PRIu64 ": %" PRIu64
            " subject%s erased again, %" PRIu64 " token%s or devices revoked again%s\n",
            l.after.seq + 1, l.to, CTL_COUNT(r.erased), CTL_COUNT(r.revoked),
            c->dry_run ? "; nothing was changed" : "");
    return ST_OK;
}

/* ---- rekey */

static const char *new_key; /* --new-key */
static bool keep_old;       /* --keep-old */
static bool to_plaintext;   /* --plaintext */

/* What the command line says of the new key; *owned is to be freed. */
static enum status read_new(struct ctl *c, struct admin_rekey *to,
                            struct crypt_file **owned)
{
    enum status st = ST_OK;

    *owned = NULL;
    *to = (struct admin_rekey){
        .kind = CRYPT_FILE, .keep = keep_old, .weak = c->short_passphrase};
    if (to_plaintext && new_key != NULL)
        return errinfo_set(&c->e, ST_EINVAL, "--plaintext contradicts --new-key");
    if (to_plaintext)
        to->kind = CRYPT_PLAINTEXT;
    else if (c->passphrase)
        to->kind = CRYPT_PASSPHRASE;
    if (new_key != NULL)
        st = crypt_file_read(new_key, owned, &c->e);
    else if (c->passphrase)
        st = ctl_model_new_key(c, "--new-key", owned);
    to->given = *owned;
    to->in_file = new_key != NULL;
    return st;
}

static void tell_rekeyed(struct ctl *c, const struct admin_rekey *to, const char *path,
                         bool completed)
{
    static const char *const word[] = {"plaintext", "file", "passphrase"};
    const bool in_file = to->in_file || to->kind == CRYPT_FILE;

    json_text(c->out, "database", c->db);
    json_text(c->out, "kind", word[to->kind]);
    json_flag(c->out, "completed", completed);
    if (completed)
        ctl_say(c, "An earlier rekey, which was interrupted, is now complete.\n");
    if (in_file)
        json_text(c->out, "key", path);
    if (in_file)
        ctl_say(c, "%s: the new key is in %s: keep a copy of it elsewhere.\n", c->db,
                path);
    else if (to->kind == CRYPT_PASSPHRASE)
        ctl_say(c, "%s: is now encrypted with the passphrase\n", c->db);
    else
        ctl_say(
            c,
            "%s: is no longer encrypted, anyone who has the file can read it; from now "
            "on use "
            "--plaintext-database.\n",
            c->db);
}

/* The old key's file goes with it, and with that whatever was backed up until now. */
static enum status confirm_loss(struct ctl *c)
{
    enum crypt_kind kind;

    if (keep_old || store_kind(c->db, &kind, &c->e) != ST_OK || kind != CRYPT_FILE)
        return ST_OK;
    return ctl_confirm(
        c, "removes the old key, which older backups need (--keep-old keeps it)",
        "rekey");
}

static enum status rekey(struct ctl *c)
{
    struct admin_rekey to;
    struct crypt_file *owned = NULL;
    struct store_key key;
    const bool passphrase = c->passphrase;
    bool completed;
    enum status st;

    c->passphrase = false; /* the option is for the new key */
    st = ctl_model_key(c, c->db, &key);
    c->passphrase = passphrase;
    if (st == ST_OK && (st = read_new(c, &to, &owned)) == ST_OK &&
        (st = confirm_loss(c)) == ST_OK &&
        (st = admin_rekey(c->db, &key, &to, c->actor, &completed, &c->e)) == ST_OK)
        tell_rekeyed(c, &to, key.path, completed);
    crypt_file_free(owned);
    return st;
}

/* ---- the commands */

const struct ctl_command ctl_backup = {
    .name = "backup",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_FORCE,
    .run = backup,
    .summary = "copy the database, also while the daemon runs",
    .help =
        "FILE is a verified copy of one moment, complete or absent, without the key. --force\n"
        "replaces an older backup.",
    .example = "surfacectl --db faces.db backup faces-monday.db"};

const struct ctl_command ctl_backup_copy = {
    .name = "copy",
    .args = "TO",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .run = copy,
    .summary = "copy the database to another engine or place, as it is",
    .help =
        "TO is a file that does not exist, or postgresql://USER@HOST/NAME, an empty database. The\n"
        "copy is verified, and opens with the same key and anchor. Stop the daemon first.",
    .example = "surfacectl --db faces.db copy postgresql://owner@db1/faces"};

const struct ctl_command ctl_backup_restore = {
    .name = "restore",
    .args = "FILE",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_DRY_RUN,
    .options = {CTL_OPTION("backup-key", "FILE", command_text, &backup_key,
                           "the key of FILE, if it differs from the present key")},
    .run = ctl_run_backup_restore,
    .summary = "replace the database with a backup",
    .help =
        "FILE is verified, and the erasures and revocations since the backup are repeated. The\n"
        "replaced database becomes PATH.before-restore. Stop the daemon first.",
    .example = "surfacectl --db faces.db restore faces-monday.db --dry-run"};

const struct ctl_command ctl_backup_reapply = {
    .name = "reapply-erasures",
    .args = "LOG",
    .takes = {1, 1},
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_DRY_RUN,
    .run = reapply,
    .summary = "after a server's restore, erase again who was erased since",
    .help =
        "LOG is the newest audit export from before the restore. Stop all daemons first;\n"
        "afterwards run accept-state with the anchor of each other daemon.",
    .example =
        "surfacectl --db postgresql://surfaced@db1/faces --key key --anchor anchor "
        "reapply-erasures log.jsonl"};

const struct ctl_command ctl_backup_rekey = {
    .name = "rekey",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_PASSPHRASE | CTL_SHORT | CTL_YES,
    .options = {CTL_OPTION("new-key", "FILE", command_text, &new_key,
                           "a file with the new key or passphrase"),
                CTL_OPTION("plaintext", NULL, command_flag, &to_plaintext,
                           "no key: anyone who has the file can read it"),
                CTL_OPTION("keep-old", NULL, command_flag, &keep_old,
                           "keep the old key, as FILE.old, and the old database, as\n"
                           "PATH.before-rekey")},
    .run = rekey,
    .summary = "replace every key of the database",
    .help =
        "A new random key replaces the one in PATH.key (or --key), unless --new-key, --passphrase\n"
        "or --plaintext chooses another. Stop the daemon first. Older backups need the old key:\n"
        "its removal must be confirmed without --keep-old. Run an interrupted rekey again.",
    .example = "surfacectl --db faces.db rekey --keep-old"};
