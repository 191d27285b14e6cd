#include "crypt_file.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "newfile.h"

/* A new file of one line, n bytes with its end: whole, or none that would be in the way. */
static enum status crypt_file_create(const char *path, const char *line, size_t n,
                                     struct errinfo *e)
{
    struct newfile file = NEWFILE_NONE;
    enum status st;

    if ((st = newfile_open(path, &file, e)) == ST_OK &&
        (st = newfile_put(&file, line, n, e)) == ST_OK)
        st = newfile_keep(&file, e);
    newfile_close(&file);
    return st;
}

enum status crypt_file_make(const char *path, struct errinfo *e)
{
    unsigned char key[CRYPT_KEY];
    char line[2 * CRYPT_KEY + 2];
    enum status st;

    randombytes_buf(key, sizeof key);
    (void)sodium_bin2hex(line, sizeof line, key, sizeof key);
    line[2 * CRYPT_KEY] = '\n';
    st = crypt_file_create(path, line, 2 * CRYPT_KEY + 1, e);
    sodium_memzero(key, sizeof key);
    sodium_memzero(line, sizeof line);
    return st;
}

enum status crypt_file_copy(const struct crypt_file *k, const char *path,
                            struct errinfo *e)
{
    char line[CRYPT_SECRET_MAX + 1];
    enum status st;

    memcpy(line, k->text, k->len);
    line[k->len] = '\n';
    st = crypt_file_create(path, line, k->len + 1, e);
    sodium_memzero(line, sizeof line);
    return st;
}

enum status crypt_file_lock(const char *path, int *fd, struct errinfo *e)
{
    int rc;

    if ((*fd = newfile_open_directory(path)) < 0)
        return errinfo_set(e, errno == EACCES ? ST_EDENIED : ST_EIO,
                           "cannot open the folder of %.160s: %s", path, strerror(errno));
    do
        rc = flock(*fd, LOCK_EX);
    while (rc != 0 && errno == EINTR);
    if (rc == 0)
        return ST_OK;
    (void)errinfo_set(e, ST_EIO, "cannot lock the folder of %.160s: %s", path,
                      strerror(errno));
    (void)close(*fd);
    *fd = -1;
    return ST_EIO;
}

static enum status crypt_file_read_line(int fd, const char *path, struct crypt_file *k,
                                        struct errinfo *e)
{
    ssize_t n = 0;

    k->len = 0;
    while (k->len < sizeof k->text &&
           (n = read(fd, k->text + k->len, sizeof k->text - k->len)) > 0)
        k->len += (size_t)n;
    if (n < 0)
        return errinfo_set(e, ST_EIO, "cannot read %.160s: %s", path, strerror(errno));
    if (k->len > 0 && k->text[k->len - 1] == '\n')
        k->len--;
    if (k->len == 0 || k->len > CRYPT_SECRET_MAX ||
        memchr(k->text, '\n', k->len) != NULL || memchr(k->text, '\0', k->len) != NULL)
        return errinfo_set(e, ST_EINVAL,
                           "%.160s: a key is one line of up to %d characters", path,
                           CRYPT_SECRET_MAX);
    k->text[k->len] = '\0';
    return ST_OK;
}

enum status crypt_file_read(const char *path, struct crypt_file **out, struct errinfo *e)
{
    struct crypt_file *k = NULL;
    struct stat sb;
    int fd;
    enum status st;

    *out = NULL;
    if ((fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)) < 0)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                           "cannot read the key %.160s: %s", path, strerror(errno));
    if (fstat(fd, &sb) != 0)
        st = errinfo_set(e, ST_EIO, "cannot read the key %.160s: %s", path,
                         strerror(errno));
    else if (S_ISREG(sb.st_mode) && (sb.st_mode & 027) != 0)
        st = errinfo_set(e, ST_EDENIED,
                         "the key %.160s may be read or changed by others "
                         "(mode %03o): chmod 600",
                         path, (unsigned)sb.st_mode & 0777);
    else if (S_ISREG(sb.st_mode) && sb.st_uid != 0 && sb.st_uid != geteuid())
        st = errinfo_set(
            e, ST_EDENIED,
            "the key %.160s belongs to user %u, who may exchange it: it must be "
            "root's, or this user's (%u)",
            path, (unsigned)sb.st_uid, (unsigned)geteuid());
    else if ((k = sodium_malloc(sizeof *k)) == NULL)
        st = errinfo_memory(e);
    else
        st = crypt_file_read_line(fd, path, k, e);
    (void)close(fd);
    if (st != ST_OK) {
        crypt_file_free(k);
        return st;
    }
    *out = k;
    return ST_OK;
}

void crypt_file_free(struct crypt_file *k)
{
    sodium_free(k);
}

enum status crypt_file_strong(const struct crypt_file *k, struct errinfo *e)
{
    size_t n = 0;

    for (size_t i = 0; i < k->len; i++) /* the bytes that begin a character of UTF-8 */
        n += ((unsigned char)k->text[i] & 0xc0) != 0x80;
    return n >= CRYPT_FILE_LEAST
               ? ST_OK
               : errinfo_set(
                     e, ST_EINVAL,
                     "the passphrase has %zu characters, fewer than %d: take a longer "
                     "one, or say --short-passphrase",
                     n, CRYPT_FILE_LEAST);
}

enum status crypt_file_key(const struct crypt_file *k, const char *path,
                           unsigned char key[CRYPT_KEY], struct errinfo *e)
{
    size_t n = 0;

    if (k->len == 2 * CRYPT_KEY &&
        sodium_hex2bin(key, CRYPT_KEY, k->text, k->len, NULL, &n, NULL) == 0 &&
        n == CRYPT_KEY)
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "%.160s: a key has %d hexadecimal digits", path,
                       2 * CRYPT_KEY);
}

enum status crypt_file_open(const struct crypt_file *k, const char *path,
                            const struct crypt_root *root, struct crypt **out,
                            struct errinfo *e)
{
    unsigned char key[CRYPT_KEY];
    struct errinfo why;
    enum status st;

    *out = NULL;
    if (root->kind != CRYPT_FILE)
        st = crypt_open(root, k->text, k->len, out, &why);
    else if ((st = crypt_file_key(k, path, key, e)) != ST_OK)
        return st;
    else
        st = crypt_open(root, key, sizeof key, out, &why);
    sodium_memzero(key, sizeof key);
    return st == ST_OK ? st : errinfo_set(e, st, "%.100s: %.120s", path, why.msg);
}

bool crypt_file_wiped(const char *path)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW);
    char text[CRYPT_SECRET_MAX + 1] = "";
    ssize_t n = -1;
    bool wiped;

    if (fd >= 0) {
        n = read(fd, text, sizeof text);
        (void)close(fd);
    }
    wiped = n > 0 && memchr(text, '\0', (size_t)n) != NULL;
    sodium_memzero(text, sizeof text);
    return wiped;
}

enum status crypt_file_fits(const char *path, const struct crypt_root *root, bool *fits,
                            struct errinfo *e)
{
    struct crypt_file *k;
    struct crypt *c = NULL;
    enum status st = crypt_file_read(path, &k, e);

    *fits = false;
    if (st != ST_OK)
        return st;
    if (root->kind == CRYPT_PLAINTEXT) /* which no secret is needed for */
        st = ST_EDENIED;
    else
        st = crypt_file_open(k, path, root, &c, e);
    *fits = st == ST_OK;
    crypt_free(c);
    crypt_file_free(k);
    return st == ST_EDENIED || st == ST_EINVAL ? ST_OK : st; /* what it says is another */
}

enum status crypt_file_root(const struct crypt_file *k, const char *path,
                            enum crypt_kind kind, struct crypt_root *root,
                            struct crypt **out, struct errinfo *e)
{
    unsigned char key[CRYPT_KEY];
    enum status st;

    *out = NULL;
    if (kind != CRYPT_FILE)
        return crypt_make(kind, k->text, k->len, root, out, e);
    if ((st = crypt_file_key(k, path, key, e)) == ST_OK)
        st = crypt_make(CRYPT_FILE, key, sizeof key, root, out, e);
    sodium_memzero(key, sizeof key);
    return st;
}
