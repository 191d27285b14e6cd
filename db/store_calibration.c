#include "store.h"

#include <inttypes.h>
#include <stdio.h>

#include "rows_calibration.h"
#include "store_txn.h"

static bool possible(const struct store_calibration *k)
{
    return surface_calibration_valid(&k->table) && k->fmr > 0 && k->fmr < 1 &&
           k->low <= k->table.threshold && k->high >= k->table.threshold &&
           k->low > -1e4 && k->high < 1e4 && k->subjects <= INT64_MAX &&
           k->impostors <= INT64_MAX && k->genuine <= INT64_MAX;
}

enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e)
{
    char version[32];
    struct log_act by;
    struct log_txn t;
    enum status st;

    if (!possible(k))
        return errinfo_set(e, ST_EINVAL, "the calibration's numbers are impossible");
    if ((st = store_act_begin(s, actor, SQL_WRITE, &by, &t, e)) != ST_OK)
        return st;
    k->version = 0;
    (void)snprintf(k->created, sizeof k->created, "%s", by.at);
    (void)snprintf(k->actor, sizeof k->actor, "%s", actor);
    (void)snprintf(k->engine, sizeof k->engine, "%s", s->made_by);
    if ((st = rows_calibration_add(&t, k, e)) == ST_OK) {
        (void)snprintf(version, sizeof version, "version %" PRId64, k->version);
        st = log_change(&t, &by, "calibrate", NULL, "", version, e);
    }
    return store_end(s, &t, st, e);
}

enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e)
{
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    return st != ST_OK ? st : store_end(s, &t, rows_calibration_get(&t, k, e), e);
}

enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e)
{
    struct log_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_end(s, &t, rows_calibration_list(&t, out, n, e), e);
}
