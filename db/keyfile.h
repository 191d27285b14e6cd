/* keyfile.h -- the file that holds a database's master key: one line of 64 hexadecimal
 * digits, or a passphrase. */
#ifndef DB_KEYFILE_H
#define DB_KEYFILE_H
#include <stddef.h>
#include "status.h"
#include "vault.h"

struct errinfo;

struct keyfile { /* in locked memory */
    size_t len;  /* of what the file says, without the end of its line */
    char text[VAULT_SECRET_MAX + 1];
};

/* keyfile_make(path, e): a new random key in a new file, readable by its owner alone and on
 * the disk.  Returns ST_OK; ST_EEXISTS: there is such a file; ST_EIO. */
enum status keyfile_make(const char *path, struct errinfo *e);

/* keyfile_copy(k, path, e): the same as keyfile_make() with what k says. */
enum status keyfile_copy(const struct keyfile *k, const char *path, struct errinfo *e);

/* keyfile_lock(path, fd, e): wait until no other caller changes the keys in that file's
 * folder; released by close(fd). */
enum status keyfile_lock(const char *path, int *fd, struct errinfo *e);

/* keyfile_move(from, to, e): in the place of what was there, and on the disk. */
enum status keyfile_move(const char *from, const char *to, struct errinfo *e);

/* keyfile_read(path, out, e): the file's one line; *out is released by keyfile_free().
 * ST_EDENIED: strangers may read or change it, or it belongs neither to root nor to this
 * process's user.  ST_ENOTFOUND; ST_EINVAL: empty, too long or more than a line; ST_EIO,
 * ST_ENOMEM. */
enum status keyfile_read(const char *path, struct keyfile **out, struct errinfo *e);
void keyfile_free(struct keyfile *k); /* wiped; NULL is allowed */

/* keyfile_strong(k, e): ST_EINVAL: fewer characters than a new passphrase should have. */
#define KEYFILE_LEAST 12
enum status keyfile_strong(const struct keyfile *k, struct errinfo *e);

/* keyfile_open(k, path, root, out, e): the vault of a root by what the file says, as
 * vault_open(); the text names the file. */
enum status keyfile_open(const struct keyfile *k, const char *path,
                         const struct vault_root *root, struct vault **out,
                         struct errinfo *e);

/* keyfile_key(k, path, key, e): the 32 bytes; ST_EINVAL: not 64 hexadecimal digits. */
enum status keyfile_key(const struct keyfile *k, const char *path,
                        unsigned char key[VAULT_KEY], struct errinfo *e);

#endif
