/* accept-state: a database that is not as it was written, or older, taken as it is. */
#include <inttypes.h>

#include "admin_restore.h"
#include "ctl_command.h"
#include "ctl_key.h"

static void report(void *arg, const char *line)
{
    const struct ctl *c = arg;

    json_text(c->out, NULL, line);
    ctl_say(c, "%s\n", line);
}

static enum status accept_state(struct ctl *c)
{
    struct admin_accepted found;
    struct store_key key;
    enum status st = ctl_key(c, c->db, &key);

    if (st != ST_OK ||
        (!c->dry_run &&
         (st = ctl_confirm(
              c,
              "accepts the database as it is and discards every later change, "
              "erasures and revocations included",
              "accept")) != ST_OK))
        return st;
    json_array(c->out, "problems");
    st = admin_accept(c->db, &key, c->actor, c->dry_run, report, c, &found, &c->e);
    json_close(c->out);
    if (st != ST_OK)
        return st;
    json_text(c->out, "database", c->db);
    json_flag(c->out, "differed", found.differed);
    json_number(c->out, "rows_removed", (double)found.removed);
    json_flag(c->out, "dry_run", c->dry_run);
    ctl_say(c, "%s: %s; %" PRIu64 " row%s %sremoved\n", c->db,
            c->dry_run ? "nothing was changed"
                       : "accepted, with an entry in the change log",
            found.removed, found.removed == 1 ? "" : "s", c->dry_run ? "would be " : "");
    return ST_OK;
}

const struct ctl_command ctl_accept = {
    .name = "accept-state",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_YES | CTL_DRY_RUN,
    .run = accept_state,
    .summary = "take a database as it is, whatever its log and anchor say",
    .help =
        "A database whose rows are not those of its last change is refused, and one that is older\n"
        "than its anchor, or without it.  Where that is meant, as after a snapshot of the file\n"
        "system was put back, or where there is no backup, this accepts the database as it is now:\n"
        "rows that are not authentic are removed, and an entry in the change log says so.  A\n"
        "backup is put back by surfacectl restore instead, which repeats the erasures since.",
    .example = "surfacectl --db faces.db accept-state --dry-run"};
