/* admin_import.h -- subjects and templates out of an archive. */
#ifndef DB_ADMIN_IMPORT_H
#define DB_ADMIN_IMPORT_H
#include "store_open.h"

struct admin_imported {
    uint64_t subjects, templates;         /* of the archive */
    uint64_t new_subjects, new_templates; /* the others are there already */
    uint64_t erased;   /* were erased here: left out, with their templates */
    uint64_t outdated; /* of the templates: of another engine */
};

/* admin_import(s, actor, path, k, dry, out, e): an archive as a whole, or nothing of it;
 * what is there already is left as it is, also a subject that has another id here by now.  Left
 * out are subjects that were erased here, under whatever id.  All of it is verified first; with dry
 * nothing else is done.  Templates of another engine are taken as they are, and outdated.
 * ST_EVERSION: an archive or a template's face of a newer version; ST_EEXISTS: a template's
 * id is another's here, or a subject's id is another person's: whom an id means here is not for
 * an archive to say; ST_EFULL: a subject would have more than STORE_TEMPLATES_MAX; as
 * admin_archive_read(). */
enum status admin_import(struct store *s, const char *actor, const char *path,
                         const struct crypt_file *k, bool dry, struct admin_imported *out,
                         struct errinfo *e);

#endif
