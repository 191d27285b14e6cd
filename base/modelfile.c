#include "modelfile.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "libsurface.h"
#include "newfile.h"

/* The content of an open file, released by free(). */
static enum status slurp(FILE *in, const char *path, char **text, size_t *len,
                         struct errinfo *e)
{
    struct stat about;

    if (fstat(fileno(in), &about) != 0)
        return errinfo_set(e, ST_EIO, "%.160s: %s", path, strerror(errno));
    if (!S_ISREG(about.st_mode))
        return errinfo_set(e, ST_EINVAL, "%.160s: not a regular file", path);
    if (about.st_size < 0 || (uintmax_t)about.st_size > MODELFILE_MAX)
        return errinfo_set(e, ST_ESIZE, "%.160s: larger than a model, %zu MB", path,
                           MODELFILE_MAX >> 20);
    *len = (size_t)about.st_size;
    if ((*text = malloc(*len + 1)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "%.160s: out of memory", path);
    if (fread(*text, 1, *len, in) != *len)
        return errinfo_set(e, ST_EIO, "%.160s: it cannot be read to its end", path);
    return ST_OK;
}

enum status modelfile_read(const char *path, struct surface_model **out,
                           struct errinfo *e)
{
    /* Without O_NONBLOCK, open() waits on a pipe until another process writes to it. */
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    FILE *in = fd >= 0 ? fdopen(fd, "r") : NULL;
    char *text = NULL;
    size_t len = 0;
    uint32_t line = 0;
    enum status st;

    *out = NULL;
    if (in == NULL) {
        st = errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%.160s: %s", path,
                         strerror(errno));
        if (fd >= 0)
            (void)close(fd);
        return st;
    }
    if ((st = slurp(in, path, &text, &len, e)) != ST_OK)
        goto out;
    st = status_from(surface_model_parse(text, len, out, &line));
    if (st == ST_ENOMEM)
        (void)errinfo_set(e, st, "%.160s: out of memory", path);
    else if (st == ST_EVERSION)
        (void)errinfo_set(e, st,
                          "%.160s: a model of a version that this program does "
                          "not read",
                          path);
    else if (st != ST_OK)
        (void)errinfo_set(e, st, "%.160s, line %" PRIu32 ": not a model, or damaged",
                          path, line);
out:
    free(text);
    (void)fclose(in);
    return st;
}

/* The daemon, another user, reads models: the umask decides, not newfile's 0600. */
static void make_readable(int fd)
{
    const mode_t mask = umask(077);

    (void)umask(mask);
    (void)fchmod(fd, 0666 & ~mask);
}

enum status modelfile_write(const char *path, bool replace, const struct surface_model *m,
                            struct errinfo *e)
{
    const size_t len = surface_model_write(m, NULL, 0);
    struct newfile file = NEWFILE_NONE;
    char *text = malloc(len + 1);
    enum status st;

    if (text == NULL)
        return errinfo_set(e, ST_ENOMEM, "%.160s: out of memory", path);
    (void)surface_model_write(m, text, len + 1);
    if ((st = newfile_open(path, &file, e)) == ST_OK &&
        (st = newfile_put(&file, text, len, e)) == ST_OK) {
        make_readable(file.fd);
        st = replace ? newfile_commit(&file, e) : newfile_keep(&file, e);
    }
    newfile_close(&file);
    free(text);
    return st;
}
