#include "store_trim.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "errinfo.h"
#include "row_event.h"
#include "store_column.h"
#include "store_rules.h"
#include "store_txn.h"
#include "utc.h"

#define BATCH 20000 /* entries: other writers wait for about 0.1 s */
#define DAY   INT64_C(86400000)

/* The last of the uses after the entry `after`, at most a batch, that is from before `until`, and
 * its hash; how many there are.  Their times follow each other but where the clock was set. */
static enum status find_last(struct store_txn *t, uint64_t after, const char *until,
                             uint64_t *last, struct row_event_row *left, uint64_t *n,
                             struct errinfo *e)
{
    char at[32];
    struct sql_rows *r;
    enum status st =
        SQL_QUERY(t->sql, &r, e,
                  "SELECT seq, at, hash FROM events WHERE chain = 1 AND seq > $1 "
                  "ORDER BY seq LIMIT $2",
                  sql_int((int64_t)after), sql_int(BATCH));

    *n = 0;
    while (st == ST_OK && sql_next(r)) {
        if (store_column_text(r, 1, at, sizeof at) && strcmp(at, until) >= 0)
            break;
        if (!store_column_bytes(r, 2, left->mac, sizeof left->mac))
            st = errinfo_set(e, ST_ECORRUPT, "an entry of the audit log is damaged");
        *last = (uint64_t)sql_column(r, 0).i;
        ++*n;
    }
    return sql_done(r, st, e);
}

static enum status cut_off(struct store_txn *t, const struct store_act *by, uint64_t last,
                           struct row_event_row *left, struct errinfo *e)
{
    char outcome[32];
    enum status st;

    memcpy(left->object, row_event_uses, sizeof left->object);
    (void)snprintf(outcome, sizeof outcome, "%" PRIu64, last);
    if ((st = SQL_RUN(t->sql, e, "DELETE FROM events WHERE chain = 1 AND seq <= $1",
                      sql_int((int64_t)last))) != ST_OK ||
        (st = SQL_RUN(t->sql, e, "DELETE FROM checkpoints WHERE chain = 1 AND seq <= $1",
                      sql_int((int64_t)last))) != ST_OK)
        return st;
    return row_event_leave(t, by, STORE_CHAIN_TRIM, "", "", outcome, left, e);
}

enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e)
{
    struct row_event_row left = {.gone = false};
    char until[UTC_TEXT];
    struct store_act by;
    struct store_txn t;
    uint64_t last = 0, n;
    enum status st;

    *cut = 0;
    if (days < 1 || days > STORE_TRIM_MAX)
        return errinfo_set(e, ST_EINVAL, "uses are kept for 1 to %d days",
                           STORE_TRIM_MAX);
    do {
        n = 0;
        if ((st = store_rules_act(&by, actor, e)) != ST_OK ||
            (st = store_txn_begin(s, dry ? SQL_READ : SQL_WRITE, &t, e)) != ST_OK)
            return st;
        utc_print(by.ms > days * DAY ? by.ms - days * DAY : 0, until);
        st = find_last(&t, last, until, &last, &left, &n, e);
        if (st == ST_OK && n > 0 && !dry)
            st = cut_off(&t, &by, last, &left, e);
        if ((st = store_txn_end(&t, st, e)) == ST_OK)
            *cut += n;
    } while (st == ST_OK && n == BATCH);
    return st;
}
