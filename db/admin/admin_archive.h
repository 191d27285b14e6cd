/* admin_archive.h -- a file of encrypted records, one after the other: libsodium's secretstream
 * (XChaCha20-Poly1305), so that none can be changed, left out, moved or cut off.  What the
 * records say is store_archive.h's.  Layout: db/FORMAT.md. */
#ifndef DB_ADMIN_ARCHIVE_H
#define DB_ADMIN_ARCHIVE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include "status.h"

#define ADMIN_ARCHIVE_RECORD_MAX                                                         \
    (96U << 20) /* bytes: a model of 2^21 points takes 84 MB */

struct admin_archive;
struct errinfo;
struct crypt_file; /* keyfile.h */

/* admin_archive_create(to, k, out, e): k: 64 hexadecimal digits are the key, anything else is a
 * passphrase, for Argon2id.  to is borrowed.  ST_EIO, ST_ENOMEM.
 * admin_archive_write(a, data, n, last, e): a record; nothing follows the last. */
enum status admin_archive_create(FILE *to, const struct crypt_file *k,
                                 struct admin_archive **out, struct errinfo *e);
enum status admin_archive_write(struct admin_archive *a, const void *data, size_t n,
                                bool last, struct errinfo *e);

/* admin_archive_open(from, k, out, e): ST_ECORRUPT: no archive; ST_EVERSION: of a newer version;
 * ST_EDENIED: it needs the other sort of key.
 * admin_archive_read(a, data, n, last, e): the next record, which is the archive's until the next
 * call.  ST_EDENIED: the first one is not encrypted with this key; ST_ECORRUPT: one is damaged,
 * or the file ends before the last or goes on after it; ST_EIO, ST_ENOMEM. */
enum status admin_archive_open(FILE *from, const struct crypt_file *k,
                               struct admin_archive **out, struct errinfo *e);
enum status admin_archive_read(struct admin_archive *a, const unsigned char **data,
                               size_t *n, bool *last, struct errinfo *e);

void admin_archive_close(struct admin_archive *a); /* wiped; NULL is allowed */

#endif
