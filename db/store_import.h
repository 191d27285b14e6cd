/* store_import.h -- subjects and templates out of an archive. */
#ifndef DB_STORE_IMPORT_H
#define DB_STORE_IMPORT_H
#include "store_types.h"

/* store_import(s, actor, path, k, dry, out, e): an archive as a whole, or nothing of it;
 * what is there already is left as it is, also a subject that has another id here by now.  Left
 * out are subjects that were erased here, under whatever id, and those whose id an erased one
 * had, unless there is one of that id again.  All of it is verified first; with dry nothing
 * else is done.  Templates of another engine are taken as they are, and outdated.
 * ST_EVERSION: an archive or a template's model of a newer version; ST_EEXISTS: a template's
 * id is another's here; ST_EFULL: a subject would have more than STORE_TEMPLATES_MAX templates; as
 * archive_read(). */
enum status store_import(struct store *s, const char *actor, const char *path,
                         const struct keyfile *k, bool dry, struct store_imported *out,
                         struct errinfo *e);

#endif
