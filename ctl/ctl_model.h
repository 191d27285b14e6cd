/* ctl_model.h -- the model that a command judges by, and the database opened for it by its key,
 * which the command line names or which is asked for on the terminal. */
#ifndef CTL_MODEL_H
#define CTL_MODEL_H
#include "store.h"

struct crypt_file;    /* crypt_file.h */
struct ctl;           /* ctl.h */
struct surface_model; /* libsurface.h */

/* ctl_model_read(c, owned): set c->model and c->engine by c->model_path; *owned is for the
 * caller to release by surface_model_free() when c is done.  c->e is filled on failure, as by all of these.
 * ctl_model_open(c, mode): open the database as c->store, for that model; says on standard
 * error where its calibration is not used with it. */
enum status ctl_model_read(struct ctl *c, struct surface_model **owned);
enum status ctl_model_open(struct ctl *c, enum store_mode mode);

/* ctl_model_key(c, db, key): the key that the command line names for the database; a passphrase
 * is asked for on the terminal, once.
 * ctl_model_new_key(c, option, out): a new passphrase, typed twice there; for crypt_file_free().
 * option: what names a file with it instead.
 * ctl_model_archive_key(c, make, out): the key or passphrase that encrypts an archive; asked for
 * twice where an archive is made.  Released by crypt_file_free(). */
enum status ctl_model_key(struct ctl *c, const char *db, struct store_key *key);
enum status ctl_model_new_key(struct ctl *c, const char *option, struct crypt_file **out);
enum status ctl_model_archive_key(struct ctl *c, bool make, struct crypt_file **out);

/* ctl_model_each(s, visit, arg, e): visit(arg, one, e) each subject, in order of creation; not
 * all are in memory at once.  ST_ENOTFOUND of a visit is ignored: the subject was erased since it
 * was listed.  Ends with the first other failure. */
enum status ctl_model_each(struct store *s,
                           enum status (*visit)(void *arg,
                                                const struct store_subject *one,
                                                struct errinfo *e),
                           void *arg, struct errinfo *e);

#endif
