/* rows_calibration.h -- the calibrations' rows, inside a transaction.  They are only ever added. */
#ifndef DB_ROWS_CALIBRATION_H
#define DB_ROWS_CALIBRATION_H
#include "rows_table.h"
#include "rows_types.h"

extern const struct rows_table rows_calibrations;

/* rows_calibration_add(t, k, e): append *k, complete; where its version is 0, the one
 * after the newest, which must be authentic.
 * rows_calibration_get(t, k, e): the newest; ST_ENOTFOUND where there never was one.
 * rows_calibration_list(t, out, n, e): all, oldest first; released by free(). */
enum status rows_calibration_add(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e);
enum status rows_calibration_get(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e);
enum status rows_calibration_list(struct log_txn *t, struct store_calibration **out,
                                  size_t *n, struct errinfo *e);

#endif
