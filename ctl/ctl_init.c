/* init: a new database. */
#include <limits.h>
#include <stdio.h>
#include <unistd.h>

#include "ctl_command.h"
#include "ctl_model.h"

/* Make or upgrade; the key's file is new where there was none before. */
static enum status open_new(struct ctl *c, enum store_mode mode, const char *word)
{
    char usual[PATH_MAX];
    const char *path = c->key != NULL ? c->key : usual;
    bool there;
    enum status st;

    (void)snprintf(usual, sizeof usual, "%s.key", c->db);
    there = access(path, F_OK) == 0;
    if ((st = ctl_model_open(c, mode)) != ST_OK)
        return st;
    json_text(c->out, "database", c->db);
    ctl_say(c, "%s: %s\n", c->db, word);
    if (access(path, F_OK) != 0)
        return ST_OK;
    json_text(c->out, "key", path);
    if (!there)
        ctl_say(c,
                "The key is in %s: keep a copy of it elsewhere.  Without it nothing in "
                "the database can be read.\n",
                path);
    return ST_OK;
}

static enum status init(struct ctl *c)
{
    enum crypt_kind kind;
    const bool there = store_kind(c->db, &kind, NULL) == ST_OK;
    const enum status st =
        open_new(c, STORE_CREATE, there ? "was initialised before" : "initialised");

    if (st != ST_OK)
        return st;
    json_flag(c->out, "created", !there);
    return ST_OK;
}

const struct ctl_command ctl_init = {
    .name = "init",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_PASSPHRASE | CTL_SHORT,
    .run = init,
    .summary = "make a new database",
    .help =
        "What identifies people is encrypted with the key in the file PATH.key, or --key.  The\n"
        "file is made if it is missing: keep a copy of it elsewhere, since without the key\n"
        "nothing in the database can be read.  An existing database is left as it is.",
    .example = "surfacectl --db faces.db init"};
