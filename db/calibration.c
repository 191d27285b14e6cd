#include "calibration.h"

#include <string.h>

#include "libsurface.h"
#include "store.h"
#include "store_open.h"

/* Was it made for the measure and the model that s is used with? */
static bool holds(const struct store *s, const struct store_calibration *k)
{
    return k->shipped || surface_same_engine(k->engine, store_made_by(s));
}

/* What *k, the newest or zeros, means for s. */
static void in_force_complete(const struct store *s, struct store_calibration *k)
{
    k->ignored = k->version != 0 && !holds(s, k);
    if (k->version == 0 || k->shipped || k->ignored) {
        k->shipped = true;
        k->table = *surface_model_calibration(store_model(s));
    }
}

enum status calibration_current(struct store *s, struct store_calibration *k,
                                struct errinfo *e)
{
    const enum status st = store_calibration_get(s, k, e);

    if (st == ST_ENOTFOUND)
        memset(k, 0, sizeof *k);
    else if (st != ST_OK)
        return st;
    in_force_complete(s, k);
    return ST_OK;
}

void calibration_apply(const struct store *s, struct store_calibration k,
                       struct surface_work *w)
{
    in_force_complete(s, &k);
    (void)surface_work_calibrate(w, k.shipped ? NULL : &k.table);
}

enum status calibration_refresh(struct store *s, struct surface_work *w, int64_t *version,
                                struct errinfo *e)
{
    struct store_calibration k;
    const enum status st = calibration_current(s, &k, e);

    if (st != ST_OK || k.version == *version)
        return st;
    calibration_apply(s, k, w);
    *version = k.version;
    return ST_OK;
}
