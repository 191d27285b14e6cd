/* store_check.h -- is everything in the database as it was written? */
#ifndef DB_STORE_CHECK_H
#define DB_STORE_CHECK_H
#include "store_types.h"

/* store_check(s, report, arg, out, e): read-only: SQLite's integrity and foreign keys,
 * every calibration valid, every template decoded, its triangulation Delaunay and its tree
 * minimal, its digest and counts right, the audit log (store_audit_verify()).  report() is
 * called once a problem with one line of text, by one thread at a time.  About 2.5 ms a
 * template of 3,000 points, shared among as many threads as there are cores.
 * store_check_rows(s, report, arg, e): the pages, tables, tokens and calibrations alone. */
enum status store_check(struct store *s, void (*report)(void *arg, const char *line),
                        void *arg, struct store_check *out, struct errinfo *e);
enum status store_check_rows(struct store *s, void (*report)(void *arg, const char *line),
                             void *arg, struct errinfo *e);

#endif
