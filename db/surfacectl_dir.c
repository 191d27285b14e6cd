#include "surfacectl_dir.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum status fail(struct errinfo *e, const char *name)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "%.120s: %s", name, strerror(errno));
}

enum status surfacectl_dir_open(const char *path, int *dir, struct errinfo *e)
{
    *dir = -1;
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return fail(e, path);
    *dir = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return *dir >= 0 ? ST_OK : fail(e, path);
}

enum status surfacectl_dir_write(int dir, const char *name,
                                 enum status (*write)(FILE *to, const void *arg,
                                                      struct errinfo *e),
                                 const void *arg, struct errinfo *e)
{
    char temp[64];
    FILE *to;
    enum status st;
    bool whole;
    int fd;

    (void)snprintf(temp, sizeof temp, ".%.32s.%ld", name, (long)getpid());
    (void)unlinkat(dir, temp, 0); /* of a process that was killed */
    fd = openat(dir, temp, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd < 0)
        return fail(e, name);
    if ((to = fdopen(fd, "wb")) == NULL) {
        st = fail(e, name);
        (void)close(fd);
        goto out;
    }
    st = write(to, arg, e);
    whole = fflush(to) == 0 && !ferror(to);
    whole = fclose(to) == 0 && whole;
    if (st == ST_OK && (!whole || renameat(dir, temp, dir, name) != 0))
        st = fail(e, name);
out:
    if (st != ST_OK)
        (void)unlinkat(dir, temp, 0);
    return st;
}

enum status surfacectl_dir_remove(int dir, const char *name, struct errinfo *e)
{
    return unlinkat(dir, name, 0) == 0 || errno == ENOENT ? ST_OK : fail(e, name);
}
