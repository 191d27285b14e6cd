/* crypt_file.h -- the file that holds a database's master key: one line of 64 hexadecimal
 * digits, or a passphrase. */
#ifndef DB_CRYPT_FILE_H
#define DB_CRYPT_FILE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "crypt.h"

struct errinfo;

struct crypt_file { /* in locked memory */
    size_t len;     /* of what the file says, without the end of its line */
    char text[CRYPT_SECRET_MAX + 1];
};

/* crypt_file_make(path, e): a new random key in a new file, readable by its owner alone and on
 * the disk.  Returns ST_OK; ST_EEXISTS: there is such a file; ST_EIO. */
enum status crypt_file_make(const char *path, struct errinfo *e);

/* crypt_file_copy(k, path, e): the same as crypt_file_make() with what k says. */
enum status crypt_file_copy(const struct crypt_file *k, const char *path,
                            struct errinfo *e);

/* crypt_file_lock(path, fd, e): wait until no other caller changes the keys in that file's
 * folder; released by close(fd). */
enum status crypt_file_lock(const char *path, int *fd, struct errinfo *e);

/* crypt_file_read(path, out, e): the file's one line; *out is released by crypt_file_free().
 * ST_EDENIED: strangers may read or change it, or it belongs neither to root nor to this
 * process's user.  ST_ENOTFOUND; ST_EINVAL: empty, too long or more than a line; ST_EIO,
 * ST_ENOMEM. */
enum status crypt_file_read(const char *path, struct crypt_file **out, struct errinfo *e);
void crypt_file_free(struct crypt_file *k); /* wiped; NULL is allowed */

/* crypt_file_strong(k, e): ST_EINVAL: fewer characters than a new passphrase should have. */
#define CRYPT_FILE_LEAST 12
enum status crypt_file_strong(const struct crypt_file *k, struct errinfo *e);

/* crypt_file_open(k, path, root, out, e): Opens root with the key or passphrase of k, as crypt_open()
 * does, into the struct crypt *out.  Error texts name the file path. */
enum status crypt_file_open(const struct crypt_file *k, const char *path,
                            const struct crypt_root *root, struct crypt **out,
                            struct errinfo *e);

/* crypt_file_fits(path, root, fits, e): Sets *fits to true if the key in the file opens root, and to
 * false if it does not.  Any other status than ST_OK proves nothing about the key: as
 * crypt_file_read(); ST_ECORRUPT: root is damaged; ST_ENOMEM. */
enum status crypt_file_fits(const char *path, const struct crypt_root *root, bool *fits,
                            struct errinfo *e);

/* crypt_file_wiped(path): Returns true if the file was a key's and was overwritten, at least in part: it
 * has a NUL, as no key has. */
bool crypt_file_wiped(const char *path);

/* crypt_file_root(k, path, kind, root, out, e): new secrets under what the file says, as
 * crypt_make(). */
enum status crypt_file_root(const struct crypt_file *k, const char *path,
                            enum crypt_kind kind, struct crypt_root *root,
                            struct crypt **out, struct errinfo *e);

/* crypt_file_key(k, path, key, e): the 32 bytes; ST_EINVAL: not 64 hexadecimal digits. */
enum status crypt_file_key(const struct crypt_file *k, const char *path,
                           unsigned char key[CRYPT_KEY], struct errinfo *e);

#endif
