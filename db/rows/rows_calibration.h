/* rows_calibration.h -- the calibrations' rows, inside a transaction.  Rows are only added. */
#ifndef DB_ROWS_CALIBRATION_H
#define DB_ROWS_CALIBRATION_H
#include "rows_table.h"
#include "rows_types.h"

extern const struct rows_table rows_calibrations; /* of struct store_calibration */

/* rows_calibration_add(t, k, e): Appends *k.  If k->version is 0, sets it to the version after the newest,
 * which must be authentic. */
enum status rows_calibration_add(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e);

/* rows_calibration_get(t, k, e): Reads the newest calibration.  ST_ENOTFOUND: there never was one. */
enum status rows_calibration_get(struct log_txn *t, struct store_calibration *k,
                                 struct errinfo *e);

#endif
