/* rows_scan.h -- the quality of the scans that a token sent on a day, inside a transaction.  These rows are
 * not authenticated: a malformed one counts as empty. */
#ifndef DB_ROWS_SCAN_H
#define DB_ROWS_SCAN_H
#include "log_txn.h"
#include "rows_types.h"

/* rows_scan_count(t, scan, e): Adds the scan to this daemon's row for the actor and the day of t->by.  It reads
 * nothing, so that on a server it costs no round trip. */
enum status rows_scan_count(struct log_txn *t, const struct store_scan *scan,
                            struct errinfo *e);

/* rows_scan_list(t, since, out, n, e): Lists the days from since on, by token and then by day, with the sums
 * of all daemons.
 *   since  "2026-11-27"
 *   out    a new array of *n elements, to be released by free() */
enum status rows_scan_list(struct log_txn *t, const char *since, struct store_scans **out,
                           size_t *n, struct errinfo *e);

#endif
