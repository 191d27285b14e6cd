#include "readfile.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "errinfo.h"

static enum status too_large(const char *path, double bytes, size_t most,
                             struct errinfo *e)
{
    return errinfo_set(e, ST_ESIZE, "%.160s: %.1f MB or more; the limit is %.1f MB", path,
                       bytes / 1e6, (double)most / 1e6);
}

static enum status read_all(FILE *in, const char *path, size_t most,
                            unsigned char **bytes, size_t *len, struct errinfo *e)
{
    size_t room = 1 << 16, n;
    struct stat info;

    if (fstat(fileno(in), &info) == 0 && S_ISREG(info.st_mode) &&
        (uintmax_t)info.st_size > most)
        return too_large(path, (double)info.st_size, most, e);
    do {
        if (*bytes == NULL || *len + 1 == room) {
            unsigned char *larger = realloc(*bytes, room *= 2);

            if (larger == NULL)
                return errinfo_set(e, ST_ENOMEM, "%.160s: out of memory", path);
            *bytes = larger;
        }
        *len += n = fread(*bytes + *len, 1, room - 1 - *len, in);
        (*bytes)[*len] = '\0';
        if (*len > most)
            return too_large(path, (double)*len, most, e);
    } while (n > 0);
    return ferror(in) ? errinfo_set(e, ST_EIO, "%.160s: %s", path, strerror(errno))
                      : ST_OK;
}

enum status readfile_all(const char *path, size_t most, unsigned char **bytes,
                         size_t *len, struct errinfo *e)
{
    const bool standard = strcmp(path, "-") == 0;
    FILE *in = standard ? stdin : fopen(path, "rb");
    enum status st;

    *len = 0;
    *bytes = NULL;
    if (in == NULL)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%.160s: %s", path,
                           strerror(errno));
    st = read_all(in, path, most, bytes, len, e);
    if (!standard)
        (void)fclose(in);
    return st;
}
