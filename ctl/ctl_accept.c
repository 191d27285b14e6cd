/* accept-rollback: an older database that was put back on purpose. */
#include "ctl_command.h"
#include "ctl_key.h"

static enum status accept_rollback(struct ctl *c)
{
    char outcome[STORE_NAME_MAX + 1];
    struct store_key key;
    enum status st = ctl_key(c, c->db, &key);

    if (st == ST_OK && key.copy)
        return ctl_usage(c, "--anchor none has nothing to be set");
    if (st != ST_OK ||
        (st = ctl_confirm(c,
                          "takes the database as it is for the newest; what was changed "
                          "after it, erasures and revocations too, is undone",
                          "accept")) != ST_OK ||
        (st = store_accept_rollback(c->db, &key, c->actor, outcome, &c->e)) != ST_OK)
        return st;
    json_text(c->out, "database", c->db);
    json_text(c->out, "outcome", outcome);
    ctl_say(c, "%s: accepted (%s); the audit log has an entry\n", c->db, outcome);
    return ST_OK;
}

const struct ctl_command ctl_accept = {
    .name = "accept-rollback",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_YES,
    .run = accept_rollback,
    .summary = "take an older database that was put back",
    .help =
        "A database that is older than its anchor is refused, and one without its anchor.  Where\n"
        "that is meant, as after a snapshot of the file system was put back, this accepts the\n"
        "database as it is now, once, with an entry in the audit log.  A backup is put back by\n"
        "surfacectl restore instead, which repeats the erasures since.",
    .example = "surfacectl --db faces.db accept-rollback"};
