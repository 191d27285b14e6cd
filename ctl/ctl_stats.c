/* stats and vacuum: how large the database is; smaller. */
#include <stdio.h>

#include "ctl_command.h"

static enum status stats(struct ctl *c)
{
    struct store_stats t;
    char text[32];
    uint64_t other = 0;
    enum status st;

    if ((st = store_stats(c->store, &t, &c->e)) != ST_OK ||
        (st = store_reencode_count(c->store, &other, &c->e)) != ST_OK)
        return st;
    json_number(c->out, "subjects", (double)t.subjects);
    json_number(c->out, "templates", (double)t.templates);
    json_number(c->out, "to_reencode", (double)other);
    json_number(c->out, "points", (double)t.points);
    json_number(c->out, "template_bytes", (double)t.template_bytes);
    json_number(c->out, "file_bytes", (double)t.file_bytes);
    json_number(c->out, "events", (double)t.events);
    json_number(c->out, "tokens", (double)t.tokens);
    json_number(c->out, "schema", t.schema);
    ctl_say(c, "subjects     %llu\n", (unsigned long long)t.subjects);
    ctl_say(c, "templates    %llu", (unsigned long long)t.templates);
    if (other > 0)
        ctl_say(c, ", %llu by another engine (template reencode)",
                (unsigned long long)other);
    ctl_say(c, "\n");
    ctl_say(c, "points       %llu\n", (unsigned long long)t.points);
    ctl_say(c, "encoded      %s\n", ctl_bytes(t.template_bytes, text));
    ctl_say(c, "file         %s\n", ctl_bytes(t.file_bytes, text));
    if (t.points > 0)
        ctl_say(c, "per point    %.1f bytes of template, %.1f of file\n",
                (double)t.template_bytes / (double)t.points,
                (double)t.file_bytes / (double)t.points);
    ctl_say(c, "events       %llu\n", (unsigned long long)t.events);
    ctl_say(c, "tokens       %llu\n", (unsigned long long)t.tokens);
    ctl_say(c, "schema       %u\n", t.schema);
    return ST_OK;
}

static enum status vacuum(struct ctl *c)
{
    struct store_stats before, after;
    char was[32], is[32];
    enum status st;

    if ((st = store_stats(c->store, &before, &c->e)) != ST_OK ||
        (st = store_vacuum(c->store, &c->e)) != ST_OK ||
        (st = store_stats(c->store, &after, &c->e)) != ST_OK)
        return st;
    json_number(c->out, "bytes_before", (double)before.file_bytes);
    json_number(c->out, "bytes_after", (double)after.file_bytes);
    ctl_say(c, "%s: %s before, %s now\n", c->db, ctl_bytes(before.file_bytes, was),
            ctl_bytes(after.file_bytes, is));
    return ST_OK;
}

const struct ctl_command ctl_stats = {
    .name = "stats",
    .database = CTL_READS_DATABASE,
    .shared = CTL_MODEL,
    .run = stats,
    .summary = "count what is in the database",
    .help = "Subjects, templates, points, events and tokens, and what they take on disk.",
    .example = "surfacectl --db faces.db stats"};

const struct ctl_command ctl_stats_vacuum = {
    .name = "vacuum",
    .database = CTL_WRITES_DATABASE,
    .run = vacuum,
    .summary = "give the room of deleted rows back to the disk",
    .help =
        "The database is written again, so it takes as much room once more while this runs, and\n"
        "nobody else can write: a running daemon responds with 503 to an enrolment that would wait\n"
        "more than 5 seconds.",
    .example = "surfacectl --db faces.db vacuum"};
