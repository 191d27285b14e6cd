/* admin_archive.h -- archives: subjects and their templates moved between stores.  An archive is a store file
 * that has nothing else, under a key of its own. */
#ifndef DB_ADMIN_ARCHIVE_H
#define DB_ADMIN_ARCHIVE_H
#include "admin_check.h"

/* admin_export(s, actor, subjects, n, path, k, replace, out, e): Writes subjects with their templates into a new
 * archive, verifies it, and appends an access for each subject.  The archive is complete or absent.
 *   subjects  ids [n]; n 0: all subjects
 *   k         key of the archive, 64 hexadecimal digits, or else a passphrase
 *   replace   a file at path may be replaced
 * ST_EEXISTS: there is a file at path; ST_ENOTFOUND: no such subject. */
enum status admin_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct crypt_file *k,
                         bool replace, struct admin_copied *out, struct errinfo *e);

struct admin_imported {
    uint64_t subjects, templates;         /* counts of the archive */
    uint64_t new_subjects, new_templates; /* subjects and templates that were added */
    uint64_t erased; /* subjects that were erased here: left out, with their templates */
    uint64_t outdated; /* templates of another engine */
};

/* admin_import(s, actor, path, k, dry, force, out, e): Imports an archive as a whole, or nothing of it.  First
 * verifies and decodes all of it.  Subjects and templates that exist stay as they are, also if the subject
 * has another id here.  Subjects that were erased here, under any id, are left out.  Templates of another
 * engine are imported as they are.
 *   dry    only verify, and set *out
 *   force  an enrolled subject may get another template; no faces are compared
 * ST_EDENIED: k is not its key; ST_ECORRUPT: no archive, or damaged; ST_EVERSION: of a newer version;
 * ST_EFULL: a subject would have more than STORE_TEMPLATES_MAX templates.
 * ST_EEXISTS: a new template of an enrolled subject, without force; or the id of a template or of a
 * subject belongs to another one here: an archive cannot say whom an id means. */
enum status admin_import(struct store *s, const char *actor, const char *path,
                         const struct crypt_file *k, bool dry, bool force,
                         struct admin_imported *out, struct errinfo *e);

#endif
