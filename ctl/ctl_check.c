/* check-database: the whole database, read and verified. */
#include <inttypes.h>
#include <stdio.h>

#include "admin_check.h"
#include "ctl_command.h"

static void report(void *arg, const char *line)
{
    const struct ctl *c = arg;

    json_text(c->out, NULL, line);
    ctl_say(c, "%s\n", line);
}

static enum status check(struct ctl *c)
{
    struct admin_check found;
    enum status st;

    json_array(c->out, "problems");
    st = admin_check(c->store, true, report, c, &found, &c->e);
    json_close(c->out);
    if (st != ST_OK)
        return st;
    c->code = found.problems == 0 ? EXIT_FINE : EXIT_NO;
    json_number(c->out, "templates", (double)found.templates);
    json_number(c->out, "bad_templates", (double)found.bad_templates);
    json_number(c->out, "events", (double)found.events);
    json_flag(c->out, "ok", found.problems == 0);
    ctl_say(c,
            "%s: %" PRIu64 " template%s, %llu bad; %" PRIu64 " event%s; %" PRIu64
            " problem%s in all\n",
            found.problems == 0 ? "ok" : "NOT ok", CTL_COUNT(found.templates),
            (unsigned long long)found.bad_templates, CTL_COUNT(found.events),
            CTL_COUNT(found.problems));
    return ST_OK;
}

const struct ctl_command ctl_check = {
    .name = "check-database",
    .database = CTL_READS_DATABASE,
    .exits = {"no problems", "problems were found"},
    .run = check,
    .summary = "read and verify the whole database",
    .help =
        "The database's integrity and references; the rows against the change log, and both logs;\n"
        "of each template the triangulation (Delaunay), spanning tree (minimal), digest and counts.\n"
        "Nothing is changed.",
    .example = "surfacectl --db faces.db check-database"};
