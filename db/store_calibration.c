#include "store.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "rows_calibration.h"
#include "store_txn.h"

static bool possible(const struct store_calibration *k)
{
    return surface_calibration_valid(&k->table) && det_valid(&k->det) && k->fmr > 0 &&
           k->fmr < 1 && k->low <= k->table.threshold && k->high >= k->table.threshold &&
           k->low > -1e4 && k->high < 1e4 && k->subjects <= INT64_MAX &&
           k->impostors <= INT64_MAX && k->genuine <= INT64_MAX;
}

enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e)
{
    char version[32];
    struct log_txn t;
    enum status st;

    if (!possible(k))
        return errinfo_set(e, ST_EINVAL, "the calibration's numbers are impossible");
    if ((st = store_act_begin(s, actor, SQL_WRITE, &t, e)) != ST_OK)
        return st;
    k->version = 0;
    (void)snprintf(k->created, sizeof k->created, "%s", t.by.at);
    (void)snprintf(k->actor, sizeof k->actor, "%s", actor);
    (void)snprintf(k->engine, sizeof k->engine, "%s", s->made_by);
    if ((st = rows_calibration_add(&t, k, e)) == ST_OK) {
        (void)snprintf(version, sizeof version, "version %" PRId64, k->version);
        st = log_change(&t, "calibrate", NULL, "", version, e);
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
    void *list;
    const enum status st = store_list(s, &rows_calibrations, sizeof **out, &list, n, e);

    *out = list;
    return st;
}

/* ---- the calibration in force */

/* Returns true if *k was made for the measure and the model that s is used with. */
static bool holds(const struct store *s, const struct store_calibration *k)
{
    return k->shipped || surface_same_engine(k->engine, s->made_by);
}

/* Completes *k, the newest or zeros: the model's own table decides if *k does not, and its law goes on where the
 * table of *k ends. */
static void complete(const struct store *s, struct store_calibration *k)
{
    k->ignored = k->version != 0 && !holds(s, k);
    if (k->version == 0 || k->shipped || k->ignored) {
        k->shipped = true;
        k->table = *surface_model_calibration(s->model);
    } else {
        surface_calibration_continue(&k->table, surface_model_calibration(s->model));
    }
}

enum status store_calibration_current(struct store *s, struct store_calibration *k,
                                      struct errinfo *e)
{
    const enum status st = store_calibration_get(s, k, e);

    if (st == ST_ENOTFOUND)
        memset(k, 0, sizeof *k);
    else if (st != ST_OK)
        return st;
    complete(s, k);
    return ST_OK;
}

void store_calibration_apply(const struct store *s, struct store_calibration k,
                             struct surface_work *w)
{
    complete(s, &k);
    (void)surface_work_calibrate(w, k.shipped ? NULL : &k.table);
}

enum status store_calibration_refresh(struct store *s, struct surface_work *w,
                                      int64_t *version, struct errinfo *e)
{
    struct store_calibration k;
    const enum status st = store_calibration_current(s, &k, e);

    if (st != ST_OK || k.version == *version)
        return st;
    store_calibration_apply(s, k, w);
    *version = k.version;
    return ST_OK;
}
