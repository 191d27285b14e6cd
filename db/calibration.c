#include "calibration.h"

#include <string.h>

#include "face.h"
#include "model.h"
#include "store.h"

/* Engines are "surfaced/VERSION measure/N": disparities of one measure are no others'. */
static bool same_measure(const char *engine)
{
    const char *theirs = strchr(engine, ' '), *ours = strchr(FACE_ENGINE, ' ');

    return theirs != NULL && strcmp(theirs, ours) == 0;
}

enum status calibration_in_force(struct store *s, struct store_calibration *k,
                                 struct errinfo *e)
{
    enum status st = store_calibration_get(s, k, e);

    if (st == ST_ENOTFOUND)
        memset(k, 0, sizeof *k);
    else if (st != ST_OK)
        return st;
    if (st == ST_ENOTFOUND || k->shipped || !same_measure(k->engine)) {
        k->shipped = true;
        k->decision = model_default.decision;
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
