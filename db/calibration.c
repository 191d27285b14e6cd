#include "calibration.h"

#include <string.h>

#include "face.h"
#include "model.h"
#include "store_calibration.h"
#include "store_open.h"

bool calibration_holds(const struct store *s, const struct store_calibration *k)
{
    return k->shipped || face_same_engine(k->engine, store_made_by(s));
}

enum status calibration_in_force(struct store *s, struct store_calibration *k,
                                 struct errinfo *e)
{
    enum status st = store_calibration_get(s, k, e);

    if (st == ST_ENOTFOUND)
        memset(k, 0, sizeof *k);
    else if (st != ST_OK)
        return st;
    k->ignored = st == ST_OK && !calibration_holds(s, k);
    if (st == ST_ENOTFOUND || k->shipped || k->ignored) {
        k->shipped = true;
        k->decision = store_model(s)->decision;
    }
    return ST_OK;
}

enum status calibration_follow(struct store *s, struct face_work *w, int64_t *version,
                               struct errinfo *e)
{
    struct store_calibration k;
    int64_t newest;
    enum status st = store_calibration_version(s, &newest, e);

    if (st != ST_OK || newest == *version)
        return st;
    if ((st = calibration_in_force(s, &k, e)) != ST_OK)
        return st;
    face_work_decide(w, k.shipped ? NULL : &k.decision);
    *version = k.version;
    return ST_OK;
}
