#include "log_anchor.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "bytes.h"
#include "errinfo.h"
#include "newfile.h"

#define PLACE 512 /* bytes from one place to the next: a sector each */
#define LINE  192 /* bytes of a line, with the NUL */

static void mac_of(const struct crypt *c, const struct log_anchor *at,
                   unsigned char out[CRYPT_HASH])
{
    unsigned char data[16 + 8 + 8 + LOG_HASH], *to = data;

    bytes_put(&to, "surface anchor 3", 16);
    bytes_put_number(&to, at->daemon, 8);
    bytes_put_number(&to, at->end.seq, 8);
    bytes_put(&to, at->end.hash, LOG_HASH);
    crypt_mac(c, data, sizeof data, out);
}

static void print(const struct crypt *c, const struct log_anchor *at, char out[LINE])
{
    unsigned char mac[CRYPT_HASH];
    char hash[2 * LOG_HASH + 1], hex[2 * CRYPT_HASH + 1];

    mac_of(c, at, mac);
    (void)sodium_bin2hex(hash, sizeof hash, at->end.hash, LOG_HASH);
    (void)sodium_bin2hex(hex, sizeof hex, mac, sizeof mac);
    (void)snprintf(out, LINE, "surface anchor 3 %" PRIu32 " %" PRIu64 " %s %s\n",
                   at->daemon, at->end.seq, hash, hex);
}

/* Is it the very line that was written for what it says? */
static bool parse(const struct crypt *c, const char *line, struct log_anchor *out)
{
    char again[LINE], hash[2 * LOG_HASH + 1];

    if (sscanf(line, "surface anchor 3 %4" SCNu32 " %20" SCNu64 " %64[0-9a-f]",
               &out->daemon, &out->end.seq, hash) != 3 ||
        out->daemon >= LOG_DAEMONS ||
        sodium_hex2bin(out->end.hash, LOG_HASH, hash, strlen(hash), NULL, NULL, NULL) !=
            0)
        return false;
    print(c, out, again);
    return sodium_memcmp(line, again, strlen(again) + 1) == 0;
}

static enum status read_places(int fd, const char *path, const struct crypt *c,
                               struct log_anchor *out, struct errinfo *e)
{
    bool found = false;

    memset(out, 0, sizeof *out);
    for (off_t i = 0; i < 2; i++) {
        char line[LINE] = "";
        struct log_anchor one;
        const ssize_t n = pread(fd, line, sizeof line - 1, i * PLACE);

        if (n < 0)
            return errinfo_set(e, ST_EIO, "cannot read the anchor %.160s: %s", path,
                               strerror(errno));
        line[strcspn(line, "\n")] = '\0';
        (void)strncat(line, "\n", sizeof line - strlen(line) - 1);
        if (parse(c, line, &one) && (!found || one.end.seq > out->end.seq)) {
            found = true;
            *out = one;
        }
    }
    return found
               ? ST_OK
               : errinfo_set(e, ST_EREFUSED,
                             "the anchor %.160s is empty, damaged, or another database's",
                             path);
}

enum status log_anchor_read(const char *path, const struct crypt *c,
                            struct log_anchor *out, struct errinfo *e)
{
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC); /* also of a FIFO */
    enum status st;

    memset(out, 0, sizeof *out);
    if (fd < 0)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                           "cannot read the anchor %.160s: %s", path, strerror(errno));
    st = read_places(fd, path, c, out, e);
    (void)close(fd);
    return st;
}

/* Of the size that it keeps: what is written later replaces bytes of it, and allocates none. */
enum status log_anchor_prepare(const char *path, const struct crypt *c,
                               const struct log_anchor *at, struct newfile *n,
                               struct errinfo *e)
{
    char *target, places[2][PLACE] = {"", ""};
    enum status st = newfile_beside(path, "", &target, e);

    if (st != ST_OK)
        return st;
    print(c, at, places[0]);
    print(c, at, places[1]);
    if ((st = newfile_open(target, n, e)) == ST_OK &&
        (st = newfile_put(n, places, sizeof places, e)) == ST_OK) {
        newfile_like(n->fd, target);
        st = newfile_sync(n, e);
    }
    free(target);
    return st;
}

enum status log_anchor_left(const char *path, const struct crypt *c,
                            struct log_anchor *out, struct errinfo *e)
{
    char *part;
    enum status st = newfile_beside(path, ".part", &part, e);

    memset(out, 0, sizeof *out);
    if (st == ST_OK)
        st = log_anchor_read(part, c, out, e);
    free(part);
    return st;
}

bool log_anchor_unknown(enum status read)
{
    return read != ST_OK && read != ST_ENOTFOUND && read != ST_EREFUSED;
}

/* Its lock is held by the command that writes it, which will give it its name. */
static enum status adopt(const char *part, const char *target, struct errinfo *e)
{
    const int fd = open(part, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    const int folder = newfile_open_directory(part);
    enum status st = ST_OK;

    if (fd < 0 || folder < 0 || flock(fd, LOCK_EX | LOCK_NB) != 0 ||
        rename(part, target) != 0)
        st = errinfo_set(e, ST_EIO, "the anchor is still called %.160s: %s", part,
                         strerror(errno));
    else
        (void)newfile_sync_directory(folder); /* or it is found as a part again */
    if (fd >= 0)
        (void)close(fd);
    if (folder >= 0)
        (void)close(folder);
    return st;
}

enum status log_anchor_adopt(const char *path, struct errinfo *e)
{
    char *target, *part = NULL;
    enum status st = newfile_beside(path, "", &target, e);

    if (st == ST_OK && (st = newfile_beside(path, ".part", &part, e)) == ST_OK &&
        !newfile_missing(part)) /* or it has its name */
        st = adopt(part, target, e);
    free(target);
    free(part);
    return st;
}

static bool write_place(int fd, const struct crypt *c, const struct log_anchor *at)
{
    char line[PLACE] = "";

    print(c, at, line);
    return pwrite(fd, line, sizeof line, (off_t)(at->end.seq % 2) * PLACE) ==
           (ssize_t)sizeof line;
}

/* It was removed or damaged since the database was opened by it. */
static enum status make_again(const char *path, const struct crypt *c,
                              const struct log_anchor *at, struct errinfo *e)
{
    struct newfile n = NEWFILE_NONE;
    enum status st = log_anchor_prepare(path, c, at, &n, e);

    if (st == ST_OK)
        st = newfile_commit(&n, e);
    newfile_close(&n);
    return st;
}

enum status log_anchor_advance(const char *path, const struct crypt *c,
                               const struct log_anchor *at, struct errinfo *e)
{
    const int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    struct log_anchor now;
    enum status st = ST_OK;

    if (fd < 0 && errno == ENOENT)
        return make_again(path, c, at, e);
    if (fd < 0 || flock(fd, LOCK_EX) != 0)
        st = errinfo_set(e, ST_EIO, "cannot write the anchor %.160s: %s", path,
                         strerror(errno));
    else if ((st = read_places(fd, path, c, &now, e)) == ST_EREFUSED)
        st = make_again(path, c, at, e);
    else if (st == ST_OK && now.end.seq < at->end.seq && !write_place(fd, c, at))
        st = errinfo_set(e, ST_EIO, "cannot write the anchor %.160s: %s", path,
                         strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    return st;
}
