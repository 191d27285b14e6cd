/* admin_check.h -- verification of everything in a database. */
#ifndef DB_ADMIN_CHECK_H
#define DB_ADMIN_CHECK_H
#include "store_open.h"

struct admin_check {
    uint64_t templates, bad_templates, events, problems; /* numbers found */
};

/* admin_check(s, decode, report, arg, out, e): Checks SQLite's integrity and foreign keys, the rows against the last
 * change, both logs (store_audit_verify()) and every calibration, and decrypts every template.  Changes
 * nothing.  Calls report() once for each problem, in one thread at a time.
 *   decode  also decodes every template: its triangulation must be Delaunay, its tree minimal, its digest
 *           and counts right.  Cost: 2.5 ms for 3,000 points, shared among as many threads as there are cores */
enum status admin_check(struct store *s, bool decode, store_report *report, void *arg,
                        struct admin_check *out, struct errinfo *e);

struct admin_copied { /* counts of a verified store */
    uint64_t subjects, templates, events, bytes;
};

/* admin_open(path, key, model, out, found, e): Opens a copy that may come from anyone, for reading, and verifies it
 * whole.
 *   key    its anchor is ignored: a copy is older than the database
 *   model  borrowed; the templates are decoded too.  NULL: they are not
 *   out    to be released by store_close()
 * ST_ECORRUPT: damaged, cut short, or followed by more bytes; or as store_open(). */
enum status admin_open(const char *path, const struct store_key *key,
                       const struct surface_model *model, struct store **out,
                       struct admin_copied *found, struct errinfo *e);

#endif
