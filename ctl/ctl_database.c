/* The database as a whole: made, verified, counted, compacted, accepted. */
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "admin_check.h"
#include "admin_join.h"
#include "admin_restore.h"
#include "ctl_command.h"
#include "ctl_model.h"
#include "drift.h"
#include "stats.h"

/* ---- init */

static enum status init(struct ctl *c)
{
    char usual[PATH_MAX];
    const char *path = c->key != NULL ? c->key : usual;
    enum crypt_kind kind;
    const bool there = store_kind(c->db, &kind, NULL) == ST_OK;
    bool had_key;
    enum status st;

    (void)snprintf(usual, sizeof usual, "%s.key", c->db);
    had_key = access(path, F_OK) == 0;
    if ((st = ctl_model_open(c, STORE_CREATE)) != ST_OK)
        return st;
    json_text(c->out, "database", c->db);
    json_flag(c->out, "created", !there);
    ctl_say(c, "%s: %s\n", c->db, there ? "is initialised already" : "initialised");
    if (access(path, F_OK) != 0)
        return ST_OK;
    json_text(c->out, "key", path);
    if (!had_key)
        ctl_say(c,
                "The key is in %s: keep a copy of it elsewhere.  Without it nothing in "
                "the database can be read.\n",
                path);
    return ST_OK;
}

const struct ctl_command ctl_database_init = {
    .name = "init",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_PASSPHRASE | CTL_SHORT,
    .run = init,
    .summary = "make a new database",
    .help =
        "Names, notes and faces are encrypted with the key in PATH.key (or --key), which is\n"
        "created if it is missing. Keep a copy of it elsewhere: without it the database cannot be\n"
        "read.",
    .example = "surfacectl --db faces.db init"};

/* ---- check-database */

static void ctl_database_report(void *arg, const char *line)
{
    const struct ctl *c = arg;

    json_text(c->out, NULL, line);
    ctl_say(c, "%s\n", line);
}

static enum status ctl_run_database_check(struct ctl *c)
{
    struct admin_check found;
    enum status st;

    json_array(c->out, "problems");
    st = admin_check(c->store, true, ctl_database_report, c, &found, &c->e);
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

const struct ctl_command ctl_database_check = {
    .name = "check-database",
    .database = CTL_READS_DATABASE,
    .exits = {"no problems", "problems were found"},
    .run = ctl_run_database_check,
    .summary = "read and verify the whole database",
    .help =
        "Verifies integrity, rows, both logs, and the digest and triangulation of each template.\n"
        "Nothing is changed.",
    .example = "surfacectl --db faces.db check-database"};

/* ---- stats, vacuum */

/* Prints the number of verifications of a day and a decision, and their median score. */
static void say_day(struct ctl *c, const struct store_day *d)
{
    uint64_t all = 0, below = 0;
    int i = 0;

    for (int k = 0; k < STORE_DAY_BINS; k++)
        all += d->bin[k];
    while (i < STORE_DAY_BINS - 1 && 2 * (below + d->bin[i]) < all)
        below += d->bin[i++];
    ctl_say(c, "%-12s %-12s %6" PRIu64 ", half of them with a score of %.0f or more\n",
            d->day, d->decision, all, STORE_DAY_FROM + STORE_DAY_STEP * i);
}

/* Prints the scans of a token, and what changed. */
static void say_scans(void *arg, const struct drift_token *t)
{
    struct ctl *c = arg;
    const struct store_scans sum = drift_sum(t->day, t->n);
    char text[DRIFT_TEXT];

    ctl_say(c, "%-12s %6" PRId64 " scan%s in 12 weeks, %" PRId64 " unusable", t->name,
            sum.n + sum.unusable, sum.n + sum.unusable == 1 ? "" : "s", sum.unusable);
    if (sum.n > 0)
        ctl_say(c, ", noise %.2f mm, quality %.2f",
                (double)sum.noise_um / 1000 / (double)sum.n,
                (double)sum.quality / 1000 / (double)sum.n);
    drift_say(&t->drift, text);
    ctl_say(c, "%s%s\n", text[0] != '\0' ? "; " : "", text);
}

static void say_stats(struct ctl *c, const struct store_stats *t, uint64_t other)
{
    char text[32];

    ctl_say(c, "subjects     %" PRIu64 "\ntemplates    %" PRIu64, t->subjects,
            t->templates);
    if (other > 0)
        ctl_say(c, ", %" PRIu64 " by another engine (template reencode)", other);
    ctl_say(c, "\npoints       %" PRIu64 "\n", t->points);
    ctl_say(c, "encoded      %s\n", ctl_bytes(t->template_bytes, text));
    ctl_say(c, "file         %s\n", ctl_bytes(t->file_bytes, text));
    if (t->points > 0)
        ctl_say(c, "per point    %.1f bytes of template, %.1f of file\n",
                (double)t->template_bytes / (double)t->points,
                (double)t->file_bytes / (double)t->points);
    ctl_say(c,
            "events       %" PRIu64 "\ntokens       %" PRIu64 "\ndevices      %" PRIu64
            "\nschema       %u\n",
            t->events, t->tokens, t->devices, t->schema);
}

static enum status stats(struct ctl *c)
{
    struct store_day *days = NULL;
    struct store_stats t;
    size_t n = 0, other = 0;
    enum status st;

    if ((st = store_stats(c->store, true, &t, &c->e)) == ST_OK &&
        (st = store_reencode_due(c->store, NULL, &other, &c->e)) == ST_OK &&
        (st = store_days(c->store, &days, &n, &c->e)) == ST_OK)
        st = stats_describe(c->out, c->store, days, n, true, &c->e);
    if (st == ST_OK) {
        json_number(c->out, "to_reencode", (double)other);
        json_number(c->out, "points", (double)t.points);
        json_number(c->out, "template_bytes", (double)t.template_bytes);
        json_number(c->out, "file_bytes", (double)t.file_bytes);
        json_number(c->out, "events", (double)t.events);
        json_number(c->out, "schema", t.schema);
        say_stats(c, &t, other);
        for (size_t i = 0; i < n; i++)
            say_day(c, &days[i]);
        st = drift_each(c->store, say_scans, c, &c->e);
    }
    free(days);
    return st;
}

static enum status vacuum(struct ctl *c)
{
    struct store_stats before, after;
    char was[32], is[32];
    enum status st;

    if ((st = store_stats(c->store, true, &before, &c->e)) != ST_OK ||
        (st = store_vacuum(c->store, &c->e)) != ST_OK ||
        (st = store_stats(c->store, true, &after, &c->e)) != ST_OK)
        return st;
    json_number(c->out, "bytes_before", (double)before.file_bytes);
    json_number(c->out, "bytes_after", (double)after.file_bytes);
    ctl_say(c, "%s: %s before, %s now\n", c->db, ctl_bytes(before.file_bytes, was),
            ctl_bytes(after.file_bytes, is));
    return ST_OK;
}

const struct ctl_command ctl_database_stats = {
    .name = "stats",
    .database = CTL_READS_DATABASE,
    .shared = CTL_MODEL,
    .run = stats,
    .summary =
        "count the contents of the database, the scores of each day, and the scans by token",
    .help =
        "Also the verifications of each of the last 180 days by decision and score, and of each\n"
        "token the scans of 12 weeks with their quality, and whether it has changed. With --json\n"
        "also the calibration in force and the findings of doctor.",
    .example = "surfacectl --db faces.db stats"};

const struct ctl_command ctl_database_vacuum = {
    .name = "vacuum",
    .database = CTL_WRITES_DATABASE,
    .run = vacuum,
    .summary = "return the space of deleted rows to the file system",
    .help =
        "Copies the database, which needs as much free disk space. Other processes can read\n"
        "meanwhile, and wait to write.",
    .example = "surfacectl --db faces.db vacuum"};

/* ---- accept-state */

static enum status accept_state(struct ctl *c)
{
    struct admin_accepted found;
    struct store_key key;
    enum status st = ctl_model_key(c, c->db, &key);

    if (st != ST_OK ||
        (!c->dry_run &&
         (st = ctl_confirm(c,
                           "accepts the older database and discards every later change, "
                           "erasures and revocations included",
                           "accept")) != ST_OK))
        return st;
    json_array(c->out, "problems");
    st = admin_accept(c->db, &key, c->actor, c->dry_run, ctl_database_report, c, &found,
                      &c->e);
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

const struct ctl_command ctl_database_accept = {
    .name = "accept-state",
    .database = CTL_NEEDS_DATABASE,
    .shared = CTL_YES | CTL_DRY_RUN,
    .run = accept_state,
    .summary = "accept the present rows, despite log and anchor",
    .help =
        "For an intended rollback, or if there is no backup: rows that are not authentic are\n"
        "removed, and every later change is lost, erasures included. If there is a backup, use\n"
        "restore.",
    .example = "surfacectl --db faces.db accept-state --dry-run"};

/* ---- join */

static enum status ctl_run_database_join(struct ctl *c)
{
    struct store_key key;
    uint32_t daemon;
    enum status st = ctl_model_key(c, c->db, &key);

    if (st != ST_OK || (st = admin_join(c->db, &key, c->actor, &daemon, &c->e)) != ST_OK)
        return st;
    json_text(c->out, "database", c->db);
    json_text(c->out, "anchor", key.anchor);
    json_number(c->out, "daemon", daemon);
    ctl_say(c, "%s: daemon %" PRIu32 "; start it with --anchor %s\n", c->db, daemon,
            key.anchor);
    return ST_OK;
}

const struct ctl_command ctl_database_join = {
    .name = "join",
    .database = CTL_NEEDS_DATABASE,
    .run = ctl_run_database_join,
    .summary = "let another daemon share a database on a server",
    .help =
        "Run it on the machine of the new daemon, with a copy of the database's key. It makes the\n"
        "new daemon's anchor (--anchor FILE); each daemon has its own.",
    .example = "surfacectl --db postgresql://surfaced@db1,db2/faces --key key --anchor "
               "anchor join"};
