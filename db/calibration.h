/* calibration.h -- the calibration in force: the newest of the store, or the table that comes
 * with the model (core/face/model.h) that the store is used with, where there is none, where the
 * newest says so, and where it was made for another measure than this program's or for another
 * model. */
#ifndef DB_CALIBRATION_H
#define DB_CALIBRATION_H
#include <stdbool.h>
#include <stdint.h>
#include "status.h"
#include "rows_types.h"

struct errinfo;
struct surface_work; /* libsurface.h */
struct store;        /* store.h */

/* calibration_current(s, k, e): *k is the newest one, or one of version 0 where there is
 * none; k->table is what decides.  k->shipped: that is the model's own table; k->ignored:
 * because the newest does not hold, which a program should say when it starts.
 * ST_ECORRUPT: the newest is damaged; nothing may be decided then. */
enum status calibration_current(struct store *s, struct store_calibration *k,
                                struct errinfo *e);

/* calibration_apply(s, k, w): w decides by k from now on, the newest as store_snapshot_begin() gave it:
 * zeros where there is none. */
void calibration_apply(const struct store *s, struct store_calibration k,
                       struct surface_work *w);

/* calibration_refresh(s, w, version, e): w decides by the calibration in force from now on.
 * *version: of the one that w decides by, 0 for a new w; the caller keeps it with w.
 * Costs some microseconds when it is the same as before.  On failure w is as it was. */
enum status calibration_refresh(struct store *s, struct surface_work *w, int64_t *version,
                                struct errinfo *e);

#endif
