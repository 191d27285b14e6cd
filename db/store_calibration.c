#include "store_calibration.h"

#include <stdio.h>

#include "errinfo.h"
#include "row_calibration.h"
#include "store_rules.h"
#include "store_txn.h"

static bool possible(const struct store_calibration *k)
{
    return calibration_valid(&k->table) && k->fmr > 0 && k->fmr < 1 &&
           k->low <= k->table.threshold && k->high >= k->table.threshold &&
           k->low > -1e4 && k->high < 1e4 && k->subjects <= INT64_MAX &&
           k->impostors <= INT64_MAX && k->genuine <= INT64_MAX;
}

enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e)
{
    struct store_act by;
    struct store_txn t;
    enum status st;

    if (!possible(k))
        return errinfo_set(e, ST_EINVAL, "the calibration's numbers are impossible");
    if ((st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_txn_begin(s, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    (void)snprintf(k->created, sizeof k->created, "%s", by.at);
    (void)snprintf(k->actor, sizeof k->actor, "%s", actor);
    (void)snprintf(k->engine, sizeof k->engine, "%s", s->made_by);
    if ((st = row_calibration_add(&t, k, e)) == ST_OK)
        st = row_calibration_tell(&t, &by, k->version, e);
    return store_txn_end(&t, st, e);
}

enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e)
{
    struct store_txn t;
    const enum status st = store_txn_begin(s, SQL_READ, &t, e);

    return st != ST_OK ? st : store_txn_end(&t, row_calibration_get(&t, k, e), e);
}

enum status store_calibration_version(struct store *s, int64_t *version,
                                      struct errinfo *e)
{
    struct store_txn t;
    const enum status st = store_txn_begin(s, SQL_READ, &t, e);

    return st != ST_OK ? st
                       : store_txn_end(&t, row_calibration_version(&t, version, e), e);
}

enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e)
{
    struct store_txn t;
    enum status st;

    *out = NULL;
    *n = 0;
    if ((st = store_txn_begin(s, SQL_READ, &t, e)) != ST_OK)
        return st;
    return store_txn_end(&t, row_calibration_list(&t, out, n, e), e);
}
