/* ctl_key.h -- keys and passphrases that the command line names or that are asked for on
 * the terminal. */
#ifndef CTL_KEY_H
#define CTL_KEY_H
#include "store.h"

struct ctl;        /* ctl.h */
struct crypt_file; /* keyfile.h */

/* ctl_key(c, db, key): the key that the command line names for the database; a passphrase
 * is asked for on the terminal, once.
 * ctl_key_new(c, option, out): a new passphrase, typed twice there; for crypt_file_free().
 * option: what names a file with it instead.
 * ctl_key_archive(c, make, out): the key or passphrase that encrypts an archive; asked for
 * twice where one is made.  Released by crypt_file_free().
 * All fill c->e on failure. */
enum status ctl_key(struct ctl *c, const char *db, struct store_key *key);
enum status ctl_key_new(struct ctl *c, const char *option, struct crypt_file **out);
enum status ctl_key_archive(struct ctl *c, bool make, struct crypt_file **out);

#endif
