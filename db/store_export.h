/* store_export.h -- subjects and their templates into an archive. */
#ifndef DB_STORE_EXPORT_H
#define DB_STORE_EXPORT_H
#include "store_types.h"

/* store_export(s, actor, subjects, n, path, k, out, e): subjects and their templates, of n
 * ids or all where n is 0, into a new archive (db/FORMAT.md), encrypted with k as
 * archive_create(); an event of each.  Whole or not at all.  ST_EEXISTS: there is a file of
 * that name; ST_ENOTFOUND: no such subject. */
enum status store_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct keyfile *k,
                         struct store_exported *out, struct errinfo *e);

#endif
