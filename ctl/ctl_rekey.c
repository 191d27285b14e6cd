/* rekey: another master key for the database. */
#include <limits.h>
#include <stdio.h>
#include <unistd.h>

#include "admin_rekey.h"
#include "crypt_file.h"
#include "ctl_command.h"
#include "ctl_key.h"

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
        return errinfo_set(&c->e, ST_EINVAL, "--plaintext takes no key");
    if (to_plaintext)
        to->kind = CRYPT_PLAINTEXT;
    else if (c->passphrase)
        to->kind = CRYPT_PASSPHRASE;
    if (new_key != NULL)
        st = crypt_file_read(new_key, owned, &c->e);
    else if (c->passphrase)
        st = ctl_key_new(c, "--new-key", owned);
    to->given = *owned;
    to->in_file = new_key != NULL;
    return st;
}

static void tell(struct ctl *c, const struct admin_rekey *to, const char *path)
{
    static const char *const word[] = {"plaintext", "file", "passphrase"};
    const bool in_file = to->in_file || to->kind == CRYPT_FILE;

    json_text(c->out, "database", c->db);
    json_text(c->out, "kind", word[to->kind]);
    if (in_file)
        json_text(c->out, "key", path);
    if (in_file)
        ctl_say(c, "%s: the new key is in %s: keep a copy of it elsewhere.\n", c->db,
                path);
    else if (to->kind == CRYPT_PASSPHRASE)
        ctl_say(c, "%s: it is encrypted with the passphrase now.\n", c->db);
    else
        ctl_say(c,
                "%s: whoever has the file can read it now; from now on it takes "
                "--plaintext-database.\n",
                c->db);
}

/* The old key's file goes with it, and with that whatever was backed up until now. */
static enum status confirm_loss(struct ctl *c)
{
    enum crypt_kind kind;

    if (keep_old || store_kind(c->db, &kind, &c->e) != ST_OK || kind != CRYPT_FILE)
        return ST_OK;
    return ctl_confirm(c,
                       "removes the old key, without which older backups cannot be read "
                       "(--keep-old keeps it)",
                       "rekey");
}

static enum status rekey(struct ctl *c)
{
    char usual[PATH_MAX];
    struct admin_rekey to;
    struct crypt_file *owned = NULL;
    struct store_key key;
    const bool passphrase = c->passphrase;
    enum status st;

    c->passphrase = false; /* it is of the new key, not of how the database is opened */
    st = ctl_key(c, c->db, &key);
    c->passphrase = passphrase;
    if (st == ST_OK && (st = read_new(c, &to, &owned)) == ST_OK &&
        (st = confirm_loss(c)) == ST_OK &&
        (st = admin_rekey(c->db, &key, &to, c->actor, &c->e)) == ST_OK) {
        (void)snprintf(usual, sizeof usual, "%s.key", c->db);
        tell(c, &to, c->key != NULL ? c->key : usual);
    }
    crypt_file_free(owned);
    return st;
}

const struct ctl_command ctl_rekey = {
    .name = "rekey",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_PASSPHRASE | CTL_SHORT | CTL_YES,
    .options = {CTL_OPTION("new-key", "FILE", ctl_option_text, &new_key,
                           "a file with the new key or passphrase"),
                CTL_OPTION("plaintext", NULL, ctl_option_flag, &to_plaintext,
                           "the new key lies in the database: whoever has the file can\n"
                           "read it"),
                CTL_OPTION("keep-old", NULL, ctl_option_flag, &keep_old,
                           "keep the old key, as FILE.old, and the old database, as\n"
                           "PATH.before-rekey")},
    .run = rekey,
    .summary = "make every key of the database anew",
    .help =
        "The database is copied under new keys, each subject's and those of hashes, MACs and\n"
        "signatures too, and the copy takes its place; the old one is overwritten and removed.  A\n"
        "new random key replaces the old one in PATH.key, or --key; or a copy of the one in\n"
        "--new-key does.  With --passphrase a passphrase is asked for, or read from --new-key;\n"
        "with --plaintext the key lies in the database.  Stop the daemon first.  Older backups\n"
        "still need the key that they were made with: unless --keep-old keeps its file, that has\n"
        "to be confirmed.  Interrupted, it is begun again.",
    .example = "surfacectl --db faces.db rekey --keep-old"};
