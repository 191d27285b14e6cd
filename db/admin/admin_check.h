/* admin_check.h -- is everything in the database as it was written? */
#ifndef DB_ADMIN_CHECK_H
#define DB_ADMIN_CHECK_H
#include "store_open.h"

struct admin_check {
    uint64_t templates, bad_templates, events, problems;
};

/* admin_check(s, decode, report, arg, out, e): read-only: SQLite's integrity and foreign keys, the rows
 * against the last change and both logs (store_audit_verify()), every calibration valid, every
 * template decrypted; with decode also decoded, its triangulation Delaunay and its tree minimal, its
 * digest and counts right, which takes about 2.5 ms a template of 3,000 points, shared among as many
 * threads as there are cores.
 * report() is called once a problem with one line of text, by one thread at a time. */
enum status admin_check(struct store *s, bool decode, store_report *report, void *arg,
                        struct admin_check *out, struct errinfo *e);

struct admin_copied { /* what is in a store that was verified */
    uint64_t subjects, templates, events, bytes;
};

/* admin_open(path, key, model, out, found, e): a copy that may come from anyone, for reading and
 * verified whole; with a model, which is borrowed, the templates are decoded too.  key->anchor is
 * not asked: a copy is older than the database.  ST_ECORRUPT: damaged, cut short or with more bytes
 * than it should have; as store_open(). */
enum status admin_open(const char *path, const struct store_key *key,
                       const struct surface_model *model, struct store **out,
                       struct admin_copied *found, struct errinfo *e);

#endif
