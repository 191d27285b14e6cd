/* init and migrate: a new database, or one of an older version. */
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
    enum vault_kind kind;
    const bool there = store_kind(c->db, &kind, NULL) == ST_OK;
    const enum status st =
        open_new(c, STORE_CREATE, there ? "was initialised before" : "initialised");

    if (st != ST_OK)
        return st;
    json_flag(c->out, "created", !there);
    return ST_OK;
}

/* What an upgrade would do. */
static enum status migrate_dry(struct ctl *c, const struct store_look *l, bool old)
{
    json_flag(c->out, "upgraded", false);
    json_flag(c->out, "would_upgrade", old);
    json_number(c->out, "schema", l->version);
    json_number(c->out, "subjects", (double)l->subjects);
    json_number(c->out, "templates", (double)l->templates);
    if (old)
        ctl_say(c,
                "%s: schema version %d, would be upgraded to %d: %llu subjects, %llu "
                "templates; the old one would be kept as %s.v%d.bak\n",
                c->db, l->version, l->newest, (unsigned long long)l->subjects,
                (unsigned long long)l->templates, c->db, l->version);
    else
        ctl_say(c, "%s: is of this version\n", c->db);
    return ST_OK;
}

static enum status migrate(struct ctl *c)
{
    struct store_look l;
    char backup[PATH_MAX];
    bool old;
    enum status st = store_look(c->db, &l, &c->e);

    if (st != ST_OK)
        return st;
    old = l.version > 0 && l.version < l.newest;
    if (c->dry_run)
        return migrate_dry(c, &l, old);
    st = open_new(c, STORE_MIGRATE,
                  old ? "upgraded to this version" : "is of this version");
    if (st != ST_OK)
        return st;
    json_flag(c->out, "upgraded", old);
    if (old) {
        (void)snprintf(backup, sizeof backup, "%s.v%d.bak", c->db, l.version);
        json_text(c->out, "backup", backup);
        ctl_say(c, "The old database is kept as %s: delete it when all is well.\n",
                backup);
    }
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

const struct ctl_command ctl_init_migrate = {
    .name = "migrate",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_DRY_RUN,
    .run = migrate,
    .summary = "upgrade a database of an older version",
    .help =
        "In one transaction.  A verified copy of the old database is kept, as PATH.v1.bak for\n"
        "version 1: delete it when all is well.",
    .example = "surfacectl --db faces.db migrate --dry-run"};
