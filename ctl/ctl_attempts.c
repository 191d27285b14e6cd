/* Failed verifications of subjects: listed, forgotten. */
#include <stdio.h>
#include <stdlib.h>

#include "ctl_command.h"

static enum status list(struct ctl *c)
{
    struct store_attempts *a;
    size_t n;
    enum status st = store_attempts_list(c->store, &a, &n, &c->e);

    if (st != ST_OK)
        return st;
    json_array(c->out, "attempts");
    if (n > 0)
        ctl_say(c, "%-32s %-32s %8s  %s\n", "SUBJECT", "TOKEN", "FAILURES", "LAST");
    for (size_t i = 0; i < n; i++) {
        json_object(c->out, NULL);
        json_text(c->out, "subject", a[i].subject);
        json_text(c->out, "token", a[i].token);
        json_number(c->out, "failures", a[i].failures);
        json_text(c->out, "last", a[i].at);
        json_close(c->out);
        ctl_say(c, "%-32s %-32s %8u  %s\n", a[i].subject,
                a[i].token[0] != '\0' ? a[i].token : "-", a[i].failures, a[i].at);
    }
    json_close(c->out);
    if (n == 0)
        ctl_say(c, "no failed verifications\n");
    free(a);
    return ST_OK;
}

static enum status reset(struct ctl *c)
{
    enum status st = store_attempts_reset(c->store, c->actor, c->args[0], &c->e);

    if (st != ST_OK)
        return st;
    json_text(c->out, "subject", c->args[0]);
    json_number(c->out, "failures", 0);
    ctl_say(c, "%s: failed verifications forgotten\n", c->args[0]);
    return ST_OK;
}

const struct ctl_command ctl_attempts_list = {
    .name = "attempts list",
    .database = CTL_READS_DATABASE,
    .run = list,
    .summary = "list the subjects that failed to be verified",
    .help =
        "After some failed verifications in a row the daemon locks a token out of a subject for\n"
        "a while, and after failures for many subjects in an hour out of all others.  The list\n"
        "says by which token how many there were, and when the last one was.",
    .example = "surfacectl --db faces.db attempts list"};

const struct ctl_command ctl_attempts_reset = {
    .name = "attempts reset",
    .args = "SUBJECT",
    .takes = {1, 1},
    .database = CTL_WRITES_DATABASE,
    .run = reset,
    .summary = "end a subject's lock-out",
    .help =
        "Its failed verifications by any token are forgotten; the daemon accepts the next one\n"
        "at once.",
    .example = "surfacectl --db faces.db attempts reset alice"};
