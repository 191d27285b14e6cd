/* store_calibration.h -- calibrations: the newest is in force (in_force.h). */
#ifndef DB_STORE_CALIBRATION_H
#define DB_STORE_CALIBRATION_H
#include "store_open.h"

/* store_calibration_add(s, actor, k, e): append *k, whose version, time, actor and engine
 * are set here; a change with it.  ST_EINVAL: its numbers are impossible. */
enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e);

/* store_calibration_get(s, k, e): the newest; ST_ENOTFOUND when there never was one.
 * store_calibration_list(s, out, n, e): all, oldest first; released by free(). */
enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e);
enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e);

#endif
