/* admin_export.h -- subjects and their templates into an archive. */
#ifndef DB_ADMIN_EXPORT_H
#define DB_ADMIN_EXPORT_H
#include "store_open.h"

struct admin_exported {
    uint64_t subjects, templates, bytes;
};

/* admin_export(s, actor, subjects, n, path, k, out, e): subjects and their templates, of n
 * ids or all where n is 0, into a new archive (db/FORMAT.md), encrypted with k as
 * admin_archive_create(); an event of each.  Whole or not at all.  ST_EEXISTS: there is a file of
 * that name; ST_ENOTFOUND: no such subject. */
enum status admin_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct crypt_file *k,
                         struct admin_exported *out, struct errinfo *e);

#endif
