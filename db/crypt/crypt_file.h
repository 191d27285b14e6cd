/* crypt_file.h -- the file that holds a database's master key: one line of 64 hexadecimal
 * digits, or a passphrase. */
#ifndef DB_CRYPT_FILE_H
#define DB_CRYPT_FILE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "crypt.h"

struct errinfo;

struct crypt_file { /* the line of a file, without its end; in locked memory */
    size_t len;     /* length of text */
    char text[CRYPT_SECRET_MAX + 1];
};

/* crypt_file_make(path, e): Writes a random key to a new file, readable only by its owner, and flushes it.
 * Returns ST_OK; ST_EEXISTS: the file exists; ST_EIO. */
enum status crypt_file_make(const char *path, struct errinfo *e);

/* crypt_file_copy(k, path, e): Writes k to a new file.  Returns as crypt_file_make(). */
enum status crypt_file_copy(const struct crypt_file *k, const char *path,
                            struct errinfo *e);

/* crypt_file_lock(path, fd, e): Waits until no other process changes the keys in the folder of path.  The lock is
 * released by close(*fd). */
enum status crypt_file_lock(const char *path, int *fd, struct errinfo *e);

/* crypt_file_read(path, out, e): Reads the one line of a file.
 *   out  to be released by crypt_file_free()
 * ST_EDENIED: other users may read or change it, or it belongs neither to root nor to this process's user;
 * ST_ENOTFOUND; ST_EINVAL: empty, too long, or more than one line; ST_EIO, ST_ENOMEM. */
enum status crypt_file_read(const char *path, struct crypt_file **out, struct errinfo *e);

/* crypt_file_free(k): Wipes and releases k; NULL is allowed. */
void crypt_file_free(struct crypt_file *k);

/* crypt_file_strong(k, e): Returns ST_EINVAL if k has fewer than CRYPT_FILE_LEAST characters, the least of a new
 * passphrase. */
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

/* crypt_file_root(k, path, kind, root, out, e): Runs crypt_make() with the key or passphrase of k.  Error texts
 * name the file path. */
enum status crypt_file_root(const struct crypt_file *k, const char *path,
                            enum crypt_kind kind, struct crypt_root *root,
                            struct crypt **out, struct errinfo *e);

/* crypt_file_key(k, path, key, e): Converts the 64 hexadecimal digits of k into a key.  ST_EINVAL: k is no such
 * key. */
enum status crypt_file_key(const struct crypt_file *k, const char *path,
                           unsigned char key[CRYPT_KEY], struct errinfo *e);

#endif
