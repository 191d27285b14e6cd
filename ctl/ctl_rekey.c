/* rekey: another master key for the database. */
#include <limits.h>
#include <stdio.h>
#include <unistd.h>

#include "keyfile.h"
#include "ctl_command.h"
#include "ctl_key.h"
#include "ctl_model.h"

static const char *new_key; /* --new-key */
static bool keep_old;       /* --keep-old */
static bool to_plaintext;   /* --plaintext */
static bool compromised;    /* --compromised */

/* What the command line says of the new key; *owned is to be freed. */
static enum status read_new(struct ctl *c, struct store_rekey *to, struct keyfile **owned)
{
    enum status st = ST_OK;

    *owned = NULL;
    *to = (struct store_rekey){.kind = VAULT_FILE,
                               .keep = keep_old,
                               .weak = c->short_passphrase,
                               .compromised = compromised};
    if (to_plaintext && new_key != NULL)
        return errinfo_set(&c->e, ST_EINVAL, "--plaintext takes no key");
    if (to_plaintext)
        to->kind = VAULT_PLAINTEXT;
    else if (c->passphrase)
        to->kind = VAULT_PASSPHRASE;
    if (new_key != NULL)
        st = keyfile_read(new_key, owned, &c->e);
    else if (c->passphrase)
        st = ctl_key_new(c, "--new-key", owned);
    to->given = *owned;
    to->in_file = new_key != NULL;
    return st;
}

static void tell(struct ctl *c, const struct store_rekey *to, const char *path)
{
    static const char *const word[] = {"plaintext", "file", "passphrase"};
    const bool in_file = to->in_file || to->kind == VAULT_FILE;

    json_text(c->out, "database", c->db);
    json_text(c->out, "kind", word[to->kind]);
    if (in_file)
        json_text(c->out, "key", path);
    if (in_file)
        ctl_say(c, "%s: the new key is in %s: keep a copy of it elsewhere.\n", c->db,
                path);
    else if (to->kind == VAULT_PASSPHRASE)
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
    enum vault_kind kind;

    if (keep_old || store_kind(c->db, &kind, &c->e) != ST_OK || kind != VAULT_FILE)
        return ST_OK;
    return ctl_confirm(c,
                       "removes the old key, without which older backups cannot be read "
                       "(--keep-old keeps it)",
                       "rekey");
}

static enum status rekey(struct ctl *c)
{
    char usual[PATH_MAX];
    struct store_rekey to;
    struct keyfile *owned = NULL;
    const bool passphrase = c->passphrase;
    enum vault_kind kind;
    enum status st;

    /* Killed, and run again: it is what it is to be. */
    if (to_plaintext && c->key == NULL && store_kind(c->db, &kind, NULL) == ST_OK &&
        kind == VAULT_PLAINTEXT)
        c->plaintext = true;
    c->passphrase = false; /* it is of the new key, not of how the database is opened */
    st = ctl_model_open(c, STORE_WRITE);
    c->passphrase = passphrase;
    if (st == ST_OK && (st = read_new(c, &to, &owned)) == ST_OK &&
        (st = confirm_loss(c)) == ST_OK &&
        (st = store_rekey(c->store, c->actor, &to, &c->e)) == ST_OK) {
        (void)snprintf(usual, sizeof usual, "%s.key", c->db);
        tell(c, &to, c->key != NULL ? c->key : usual);
    }
    keyfile_free(owned);
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
                CTL_OPTION("compromised", NULL, ctl_option_flag, &compromised,
                           "others may know the old key: every secret anew"),
                CTL_OPTION("keep-old", NULL, ctl_option_flag, &keep_old,
                           "keep the file of the old key, as FILE.old")},
    .run = rekey,
    .summary = "change the database's key",
    .help =
        "A new random key replaces the old one in PATH.key, or --key; or a copy of the one in\n"
        "--new-key does.  With --passphrase a passphrase is asked for, or read from --new-key;\n"
        "with --plaintext the key lies in the database.  A running daemon reads the new key from\n"
        "the file by itself.  Older backups still need the key that they were made with: unless\n"
        "--keep-old keeps its file, that has to be confirmed.  With --compromised each subject's\n"
        "key and those of hashes, MACs and signatures are new too, and everything is encrypted\n"
        "again; the old signing key signs the new one.  Interrupted, it goes on when it is given\n"
        "again within an hour.",
    .example = "surfacectl --db faces.db rekey --keep-old"};
