/* ctl_model.h -- the model and the database of a command. */
#ifndef CTL_MODEL_H
#define CTL_MODEL_H
#include "store.h"

struct crypt_file;    /* crypt_file.h */
struct ctl;           /* ctl.h */
struct surface_model; /* libsurface.h */

/* Every function fills c->e if it fails. */

/* ctl_model_find(c): Sets the members of c that name the model, the database, its key and its anchor, if the
 * command takes them and the command line has not set them: by the environment, or by the daemon's settings
 * if the database is not named yet, or --config is given.  A public key takes the place of a database.
 * Returns ST_OK; ST_EINVAL: no database is named, or the settings have a problem. */
enum status ctl_model_find(struct ctl *c);

/* ctl_model_free(c): Releases the settings, to which the paths in c belong. */
void ctl_model_free(struct ctl *c);

/* ctl_model_read(c, owned): Reads the model in the file c->model_path, and sets c->model and c->engine.
 *   owned   to be released by surface_model_free() when c is done; NULL: the shipped model */
enum status ctl_model_read(struct ctl *c, struct surface_model **owned);

/* ctl_model_open(c, mode): Opens the database as c->store, for c->model.  Reports on standard error if this
 * model does not use the calibration of the database. */
enum status ctl_model_open(struct ctl *c, enum store_mode mode);

/* ctl_model_key(c, db, key): Sets *key to the key that the command line names for the database db.  Asks for
 * a passphrase on the terminal, once in a process. */
enum status ctl_model_key(struct ctl *c, const char *db, struct store_key *key);

/* ctl_model_new_key(c, option, out): Asks for a new passphrase on the terminal, twice.
 *   option  the option that names a file with the passphrase instead, for the message
 *   out     to be released by crypt_file_free() */
enum status ctl_model_new_key(struct ctl *c, const char *option, struct crypt_file **out);

/* ctl_model_archive_key(c, make, out): Reads the key or passphrase of an archive, from the file --archive-key
 * or the terminal; twice if an archive is made.
 *   out     to be released by crypt_file_free() */
enum status ctl_model_archive_key(struct ctl *c, bool make, struct crypt_file **out);

/* ctl_model_each(s, visit, arg, e): Calls visit(arg, one, e) for each subject in order of creation, until one
 * call fails.  ST_ENOTFOUND of a visit is ignored: the subject was erased since it was listed.
 * Memory: a page of 1,000 subjects. */
enum status ctl_model_each(struct store *s,
                           enum status (*visit)(void *arg,
                                                const struct store_subject *one,
                                                struct errinfo *e),
                           void *arg, struct errinfo *e);

#endif
