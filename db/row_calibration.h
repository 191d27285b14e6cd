/* row_calibration.h -- the rows of calibrations, inside a transaction. */
#ifndef DB_ROW_CALIBRATION_H
#define DB_ROW_CALIBRATION_H
#include "row_event.h"
#include "store_types.h"

struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */

/* row_calibration_add(t, k, e): append *k, complete but for its version, which is set.
 * row_calibration_tell(t, by, version, e): append to the changes that this is in force from now
 * on.
 * row_calibration_version(t, version, e): the newest one's, 0 where there never was one.
 * row_calibration_get(t, k, e): the newest; ST_ENOTFOUND where there never was one.
 * row_calibration_each(t, see, arg, e): every row as it is, not verified; all of them are of one
 * object, which had each of them.
 * row_calibration_list(t, out, n, e): all, oldest first; released by free(). */
enum status row_calibration_add(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e);
enum status row_calibration_tell(struct store_txn *t, const struct store_act *by,
                                 int64_t version, struct errinfo *e);
enum status row_calibration_version(struct store_txn *t, int64_t *version,
                                    struct errinfo *e);
enum status row_calibration_get(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e);
enum status row_calibration_each(struct store_txn *t, row_event_see *see, void *arg,
                                 struct errinfo *e);
enum status row_calibration_list(struct store_txn *t, struct store_calibration **out,
                                 size_t *n, struct errinfo *e);

#endif
