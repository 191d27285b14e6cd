/* admin_archive.h -- subjects and their templates moved between stores, in an archive: a store file
 * under a key of its own that has nothing but them. */
#ifndef DB_ADMIN_ARCHIVE_H
#define DB_ADMIN_ARCHIVE_H
#include "admin_check.h"

/* admin_export(s, actor, subjects, n, path, k, replace, out, e): subjects and their templates, of n
 * ids or all where n is 0, into a new archive, verified; an event of each.  k: 64 hexadecimal digits
 * are its key, anything else is a passphrase.  Whole or not at all.  ST_EEXISTS: there is a file of
 * that name, and it is not to be replaced; ST_ENOTFOUND: no such subject. */
enum status admin_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct crypt_file *k,
                         bool replace, struct admin_copied *out, struct errinfo *e);

struct admin_imported {
    uint64_t subjects, templates;         /* of the archive */
    uint64_t new_subjects, new_templates; /* the others are there already */
    uint64_t erased;   /* were erased here: left out, with their templates */
    uint64_t outdated; /* of the templates: of another engine */
};

/* admin_import(s, actor, path, k, dry, force, out, e): an archive as a whole, or nothing of it;
 * what is there already is left as it is, also a subject that has another id here by now.  Left
 * out are subjects that were erased here, under whatever id.  All of it is verified and decoded
 * first; with dry nothing else is done.  Templates of another engine are taken as they are, and
 * outdated.
 * force: a subject who was here before may get another template: no faces are compared.
 * ST_EDENIED: not its key; ST_ECORRUPT: no archive, or it is damaged; ST_EVERSION: of a newer
 * version; ST_EEXISTS: without force, such a template; a template's id is another's here, or a subject's id is another person's:
 * whom an id means here is not for an archive to say; ST_EFULL: a subject would have more than
 * STORE_TEMPLATES_MAX. */
enum status admin_import(struct store *s, const char *actor, const char *path,
                         const struct crypt_file *k, bool dry, bool force,
                         struct admin_imported *out, struct errinfo *e);

#endif
