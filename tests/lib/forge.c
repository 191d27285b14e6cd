#include "forge.h"

#include <sqlite3.h>

#include "errinfo.h"
#include "row_calibration.h"
#include "row_event.h"
#include "row_subject.h"
#include "row_template.h"
#include "row_token.h"
#include "store_open.h"
#include "store_rules.h"
#include "store_txn.h"

static enum status run(const char *path, const char *sql, struct errinfo *e)
{
    enum status st = ST_OK;
    sqlite3 *db = NULL;

    if (sqlite3_open(path, &db) != SQLITE_OK ||
        sqlite3_busy_timeout(db, 5000) != SQLITE_OK ||
        sqlite3_exec(db, sql, NULL, NULL, NULL) != SQLITE_OK)
        st = errinfo_set(e, ST_EDB, "%.120s: %s", sql, sqlite3_errmsg(db));
    (void)sqlite3_close(db);
    return st;
}

struct forging {
    struct store_txn t;
    struct store_act by;
};

/* A row that no entry left becomes what the latest one leaves. */
static enum status leave(void *arg, const struct row_event_row *now, const char *name,
                         struct errinfo *e)
{
    struct forging *f = arg;
    bool was;
    const enum status st = row_event_was(&f->t, now, &was, e);

    (void)name;
    return st != ST_OK || was
               ? st
               : row_event_leave(&f->t, &f->by, "forge", "", "", "", now, e);
}

static enum status forge(struct forging *f, struct errinfo *e)
{
    enum status st;

    if ((st = row_subject_each(&f->t, leave, f, e)) != ST_OK ||
        (st = row_template_see(&f->t, leave, f, e)) != ST_OK ||
        (st = row_token_each(&f->t, leave, f, e)) != ST_OK)
        return st;
    return row_calibration_each(&f->t, leave, f, e);
}

enum status forge_sql(const char *path, const char *sql, struct errinfo *e)
{
    struct forging f;
    struct store *s;
    enum status st;

    if ((st = run(path, sql, e)) != ST_OK ||
        (st = store_open(path, STORE_WRITE, NULL, &s, e)) != ST_OK)
        return st;
    if ((st = store_rules_act(&f.by, "forge", e)) == ST_OK &&
        (st = store_txn_begin(s, SQL_WRITE, &f.t, e)) == ST_OK)
        st = store_txn_end(&f.t, forge(&f, e), e);
    store_close(s);
    return st;
}
