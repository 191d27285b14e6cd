#include "admin_archive.h"

#include <errno.h>
#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "crypt_file.h"

#define MAGIC   "SURFARCH"
#define VERSION 1
#define HEADER  (36 + crypto_secretstream_xchacha20poly1305_HEADERBYTES)
#define OVER    crypto_secretstream_xchacha20poly1305_ABYTES
#define KEY     crypto_secretstream_xchacha20poly1305_KEYBYTES

#define BY_KEY        1
#define BY_PASSPHRASE 2
#define PASSES        3 /* of Argon2id, as for a database's passphrase */
#define MIB           128
#define MAX_PASSES    16 /* of an archive that may come from anyone */
#define MAX_MIB       1024

enum {
    AT_VERSION = 8,
    AT_KIND = 10,
    AT_PASSES = 12,
    AT_MIB = 16,
    AT_SALT = 20,
    AT_STREAM = 36
};

struct admin_archive {
    crypto_secretstream_xchacha20poly1305_state state;
    FILE *file;
    unsigned char header[HEADER];
    bool begun, ended;
    unsigned char *record, *encrypted; /* room bytes each, and OVER more */
    size_t room, used;
};

/* The stream's key: of no other archive, also where the file's key is the same. */
static enum status derive(const struct admin_archive *a, const struct crypt_file *k,
                          unsigned char out[KEY], struct errinfo *e)
{
    const unsigned char *h = a->header;
    const unsigned mib = (unsigned)bytes_number(h + AT_MIB, 4);
    unsigned char key[CRYPT_KEY];
    enum status st;

    if (h[AT_KIND] == BY_PASSPHRASE) {
        if (crypto_pwhash(out, KEY, k->text, k->len, h + AT_SALT,
                          bytes_number(h + AT_PASSES, 4), (size_t)mib << 20,
                          crypto_pwhash_ALG_ARGON2ID13) != 0)
            return errinfo_set(e, ST_ENOMEM, "no memory for the passphrase: %u MB", mib);
        return ST_OK;
    }
    if ((st = crypt_file_key(k, "the archive's key", key, e)) != ST_OK)
        return errinfo_set(e, ST_EDENIED, "the archive needs a key, not a passphrase");
    (void)crypto_generichash(out, KEY, h, AT_STREAM, key, sizeof key);
    sodium_memzero(key, sizeof key);
    return ST_OK;
}

static struct admin_archive *new_archive(FILE *file, struct errinfo *e)
{
    struct admin_archive *a = sodium_init() < 0 ? NULL : calloc(1, sizeof *a);

    if (a == NULL)
        (void)errinfo_set(e, ST_ENOMEM, "out of memory");
    else
        a->file = file;
    return a;
}

void admin_archive_close(struct admin_archive *a)
{
    if (a == NULL)
        return;
    if (a->record != NULL)
        sodium_memzero(a->record, a->used);
    free(a->record);
    free(a->encrypted);
    sodium_memzero(a, sizeof *a);
    free(a);
}

static enum status need_room(struct admin_archive *a, size_t n, struct errinfo *e)
{
    unsigned char *p;

    if (a->encrypted != NULL && n <= a->room)
        return ST_OK;
    if (a->record != NULL)
        sodium_memzero(a->record, a->used);
    a->used = 0;
    free(a->record);
    a->room = 0;
    if ((a->record = malloc(n + 1)) == NULL ||
        (p = realloc(a->encrypted, n + OVER)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    a->encrypted = p;
    a->room = n;
    return ST_OK;
}

/* ---- writing */

static enum status put_bytes(struct admin_archive *a, const void *data, size_t n,
                             struct errinfo *e)
{
    if (fwrite(data, 1, n, a->file) == n)
        return ST_OK;
    return errinfo_set(e, ST_EIO, "cannot write the archive: %s", strerror(errno));
}

enum status admin_archive_create(FILE *to, const struct crypt_file *k,
                                 struct admin_archive **out, struct errinfo *e)
{
    unsigned char key[KEY];
    struct admin_archive *a;
    enum status st;

    *out = NULL;
    if ((a = new_archive(to, e)) == NULL)
        return ST_ENOMEM;
    memcpy(a->header, MAGIC, 8);
    bytes_set(a->header + AT_VERSION, VERSION, 2);
    a->header[AT_KIND] = BY_KEY;
    if (crypt_file_key(k, "", key, NULL) != ST_OK) {
        a->header[AT_KIND] = BY_PASSPHRASE;
        bytes_set(a->header + AT_PASSES, PASSES, 4);
        bytes_set(a->header + AT_MIB, MIB, 4);
    }
    randombytes_buf(a->header + AT_SALT, crypto_pwhash_SALTBYTES);
    if ((st = derive(a, k, key, e)) == ST_OK) {
        (void)crypto_secretstream_xchacha20poly1305_init_push(&a->state,
                                                              a->header + AT_STREAM, key);
        st = put_bytes(a, a->header, HEADER, e);
    }
    sodium_memzero(key, sizeof key);
    if (st == ST_OK)
        *out = a;
    else
        admin_archive_close(a);
    return st;
}

enum status admin_archive_write(struct admin_archive *a, const void *data, size_t n,
                                bool last, struct errinfo *e)
{
    const unsigned char tag = last ? crypto_secretstream_xchacha20poly1305_TAG_FINAL : 0;
    unsigned char length[4];
    enum status st;

    if (n > ADMIN_ARCHIVE_RECORD_MAX)
        return errinfo_set(e, ST_ELIMIT, "a record of %zu bytes is too long", n);
    if ((st = need_room(a, n, e)) != ST_OK)
        return st;
    bytes_set(length, n, 4);
    /* The first record authenticates the header, the others follow on it. */
    (void)crypto_secretstream_xchacha20poly1305_push(&a->state, a->encrypted, NULL, data,
                                                     n, a->begun ? NULL : a->header,
                                                     a->begun ? 0 : HEADER, tag);
    a->begun = true;
    if ((st = put_bytes(a, length, sizeof length, e)) == ST_OK)
        st = put_bytes(a, a->encrypted, n + OVER, e);
    return st;
}

/* ---- reading */

static enum status damaged(const struct admin_archive *a, const char *what,
                           struct errinfo *e)
{
    if (ferror(a->file))
        return errinfo_set(e, ST_EIO, "cannot read the archive: %s", strerror(errno));
    return errinfo_set(e, ST_ECORRUPT, "the archive is damaged: %s", what);
}

enum status admin_archive_open(FILE *from, const struct crypt_file *k,
                               struct admin_archive **out, struct errinfo *e)
{
    unsigned char key[KEY];
    struct admin_archive *a;
    const unsigned char *h;
    enum status st;

    *out = NULL;
    if ((a = new_archive(from, e)) == NULL)
        return ST_ENOMEM;
    h = a->header;
    if (fread(a->header, 1, HEADER, from) != HEADER || memcmp(h, MAGIC, 8) != 0)
        st = ferror(from) ? damaged(a, "", e)
                          : errinfo_set(e, ST_ECORRUPT, "not an archive of surfacectl");
    else if (bytes_number(h + AT_VERSION, 2) != VERSION)
        st = errinfo_set(e, ST_EVERSION,
                         "the archive is of version %u, this program knows %d",
                         (unsigned)bytes_number(h + AT_VERSION, 2), VERSION);
    else if ((h[AT_KIND] != BY_KEY && h[AT_KIND] != BY_PASSPHRASE) || h[AT_KIND + 1] != 0)
        st = damaged(a, "its header", e);
    else if (h[AT_KIND] == BY_PASSPHRASE &&
             (bytes_number(h + AT_PASSES, 4) < 1 ||
              bytes_number(h + AT_PASSES, 4) > MAX_PASSES ||
              bytes_number(h + AT_MIB, 4) < 1 || bytes_number(h + AT_MIB, 4) > MAX_MIB))
        st = damaged(a, "its header", e);
    else if ((st = derive(a, k, key, e)) == ST_OK &&
             crypto_secretstream_xchacha20poly1305_init_pull(&a->state, h + AT_STREAM,
                                                             key) != 0)
        st = damaged(a, "its header", e);
    sodium_memzero(key, sizeof key);
    if (st == ST_OK)
        *out = a;
    else
        admin_archive_close(a);
    return st;
}

enum status admin_archive_read(struct admin_archive *a, const unsigned char **data,
                               size_t *n, bool *last, struct errinfo *e)
{
    unsigned char length[4], tag = 0;
    enum status st;

    if (a->ended || fread(length, 1, sizeof length, a->file) != sizeof length)
        return damaged(a, "it ends too early", e);
    *n = bytes_number(length, 4);
    if (*n > ADMIN_ARCHIVE_RECORD_MAX)
        return damaged(a, "a record's length", e);
    if ((st = need_room(a, *n, e)) != ST_OK)
        return st;
    if (fread(a->encrypted, 1, *n + OVER, a->file) != *n + OVER)
        return damaged(a, "it ends too early", e);
    a->used = *n;
    if (crypto_secretstream_xchacha20poly1305_pull(
            &a->state, a->record, NULL, &tag, a->encrypted, *n + OVER,
            a->begun ? NULL : a->header, a->begun ? 0 : HEADER) != 0)
        return a->begun ? damaged(a, "a record is not what was written", e)
                        : errinfo_set(e, ST_EDENIED,
                                      "not the archive's key, or it was tampered with");
    a->begun = true;
    a->ended = *last = tag == crypto_secretstream_xchacha20poly1305_TAG_FINAL;
    if ((!*last && tag != 0) || (*last && fgetc(a->file) != EOF))
        return damaged(a, "it does not end where it should", e);
    *data = a->record;
    return ST_OK;
}
