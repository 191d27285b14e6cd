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
                             "the anchor %.160s is damaged, or another database's", path);
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

static bool write_place(int fd, const struct crypt *c, const struct log_anchor *at)
{
    char line[PLACE] = "";

    print(c, at, line);
    return pwrite(fd, line, sizeof line, (off_t)(at->end.seq % 2) * PLACE) ==
           (ssize_t)sizeof line;
}

enum status log_anchor_write(const char *path, const struct crypt *c,
                             const struct log_anchor *at, bool force, struct errinfo *e)
{
    const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    struct log_anchor now;
    bool done = false;

    if (fd >= 0 && flock(fd, LOCK_EX) == 0) {
        const bool known = !force && read_places(fd, path, c, &now, NULL) == ST_OK;

        done = known && now.end.seq >= at->end.seq;
        if (!done && (known || ftruncate(fd, 0) == 0))
            done = write_place(fd, c, at);
    }
    if (!done)
        (void)errinfo_set(e, ST_EIO, "cannot write the anchor %.160s: %s", path,
                          strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    return done ? ST_OK : ST_EIO;
}
