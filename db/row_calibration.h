/* row_calibration.h -- the rows of calibrations, inside a transaction. */
#ifndef DB_ROW_CALIBRATION_H
#define DB_ROW_CALIBRATION_H
#include "store_types.h"

struct store_txn; /* store_txn.h */

/* row_calibration_begin(t, e): of a new database, which has none.
 * row_calibration_add(t, k, e): append *k, complete but for its version, which is set.
 * row_calibration_version(t, version, e): the newest one's, 0 where there never was one.
 * row_calibration_get(t, k, e): the newest; ST_ENOTFOUND where there never was one.
 * row_calibration_list(t, out, n, e): all, oldest first; released by free().
 * row_calibration_check(t, report, arg, e): whatever is damaged is reported. */
enum status row_calibration_begin(struct store_txn *t, struct errinfo *e);
enum status row_calibration_add(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e);
enum status row_calibration_version(struct store_txn *t, int64_t *version,
                                    struct errinfo *e);
enum status row_calibration_get(struct store_txn *t, struct store_calibration *k,
                                struct errinfo *e);
enum status row_calibration_list(struct store_txn *t, struct store_calibration **out,
                                 size_t *n, struct errinfo *e);
enum status row_calibration_check(struct store_txn *t,
                                  void (*report)(void *arg, const char *line), void *arg,
                                  struct errinfo *e);

#endif
