#include "rows_digest.h"

#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "rows_calibration.h"
#include "rows_device.h"
#include "rows_subject.h"
#include "rows_template.h"
#include "rows_token.h"
#include "sql_read.h"

const char rows_digest_problem[] =
    "the rows are not those of the last change: one was removed, hidden, doubled, or put "
    "back as it was earlier";

const struct rows_table *const rows_tables[ROWS_TABLES] = {
    &rows_subjects, &rows_templates, &rows_tokens, &rows_devices, &rows_calibrations};

struct adding {
    struct log_txn *t;
    store_report *report;
    void *arg;
    unsigned char *sum;
    uint64_t problems;
    bool clear; /* rows without their MAC are deleted */
};

static enum status bad_row(struct adding *a, const struct rows_table *table,
                           const struct sql_rows *r, struct errinfo *e)
{
    enum status st = ST_OK;
    struct errinfo why;

    a->problems++;
    (void)rows_table_damaged(table, r, 0, &why);
    if (a->report != NULL)
        a->report(a->arg, why.msg);
    for (int i = 0; a->clear && st == ST_OK && i < 2; i++)
        if (table->drop[i] != NULL)
            st = SQL_RUN(a->t->sql, e, table->drop[i], sql_column(r, table->columns + 1));
    return st;
}

/* A row without its MAC has no summand.  The keys are no part of it, but each is greater than the
 * one before: else a damaged file could give its rows without end.  Lists begin with 1. */
static enum status add_table(struct adding *a, const struct rows_table *table,
                             struct errinfo *e)
{
    unsigned char mac[CRYPT_HASH];
    struct sql_rows *r;
    int64_t key = INT64_MIN, last;
    bool first = true;
    enum status st = sql_stream(a->t->sql, table->all, NULL, 0, &r, e);

    while (st == ST_OK && sql_next(r)) {
        last = key;
        if (!sql_read_int(r, table->columns + 1, INT64_MIN, &key) ||
            (key <= last && !first))
            st = errinfo_set(e, ST_ECORRUPT, "%s: its rows are not in their order",
                             table->name);
        else if (key > 0 && rows_table_is(a->t, table, r, 0, mac))
            log_txn_sum(a->t->crypt, NULL, mac, a->sum);
        else
            st = bad_row(a, table, r, e);
        first = false;
    }
    return sql_done(r, st, e);
}

enum status rows_digest(struct log_txn *t, bool clear, store_report *report, void *arg,
                        unsigned char sum[LOG_DIGEST], uint64_t *problems,
                        struct errinfo *e)
{
    struct adding a = {.t = t, .report = report, .arg = arg, .sum = sum, .clear = clear};
    enum status st = ST_OK;

    memset(sum, 0, LOG_DIGEST);
    for (size_t i = 0; i < ROWS_TABLES && st == ST_OK; i++)
        st = add_table(&a, rows_tables[i], e);
    *problems = a.problems;
    return st;
}

enum status rows_digest_orphans(struct log_txn *t, store_report *report, void *arg,
                                uint64_t *removed, struct errinfo *e)
{
    char line[80];
    enum status st = sql_run(
        t->sql, "DELETE FROM templates WHERE uid NOT IN (SELECT uid FROM subjects)", NULL,
        0, e);

    *removed = 0;
    if (st == ST_OK)
        st = sql_changed(t->sql, removed, e);
    if (*removed > 0) {
        (void)snprintf(line, sizeof line, "templates: %llu rows are of no subject",
                       (unsigned long long)*removed);
        report(arg, line);
    }
    if (st != ST_OK || (st = sql_run(t->sql,
                                     "DELETE FROM faces WHERE template_key NOT IN "
                                     "(SELECT template_key FROM templates)",
                                     NULL, 0, e)) != ST_OK)
        return st;
    return sql_run(t->sql,
                   "DELETE FROM attempts WHERE subject_key NOT IN "
                   "(SELECT subject_key FROM subjects)",
                   NULL, 0, e);
}

/* Columns that no two authentic rows may share, whatever the file's schema says.  A subject that is hidden while
 * a second one is enrolled under its id, and then put back, leaves no other difference. */
#define TWICE(table, columns, problem)                                                   \
    "SELECT '" table ": two rows " problem "' FROM " table " GROUP BY " columns          \
    " HAVING count(*) > 1 LIMIT 1"

static const char *const twice[] = {
    TWICE("subjects", "lookup", "have one id"),
    TWICE("subjects", "uid", "have one uid"),
    TWICE("templates", "id", "have one id"),
    TWICE("templates", "uid, used", "of a subject have the same points"),
    TWICE("tokens", "id", "have one id"),
    TWICE("tokens", "hash", "have one secret"),
    TWICE("devices", "id", "have one id"),
    TWICE("devices", "name", "have one name"),
    TWICE("calibrations", "calibration_key", "have one number"),
};

enum status rows_digest_twice(struct log_txn *t, store_report *report, void *arg,
                              uint64_t *problems, struct errinfo *e)
{
    enum status st = ST_OK;

    *problems = 0;
    for (size_t i = 0; i < sizeof twice / sizeof *twice && st == ST_OK; i++) {
        struct sql_rows *r;
        char line[80];

        st = sql_first(t->sql, twice[i], NULL, 0, &r, e);
        if (st == ST_OK && sql_read_text(r, 0, line, sizeof line)) {
            ++*problems;
            report(arg, line);
        }
        st = sql_done(r, st == ST_ENOTFOUND ? ST_OK : st, e);
    }
    return st;
}
