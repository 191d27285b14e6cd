#include "outfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"

/* Is the input the file at path, or at "path.part", which the new one is written as first
 * (newfile.h)? */
static bool is_same(const char *path, const char *input)
{
    char part[PATH_MAX];
    struct stat in, out;

    if (stat(input, &in) != 0 || S_ISDIR(in.st_mode))
        return false;
    if (stat(path, &out) == 0 && out.st_dev == in.st_dev && out.st_ino == in.st_ino)
        return true;
    (void)snprintf(part, sizeof part, "%s.part", path);
    return stat(part, &out) == 0 && out.st_dev == in.st_dev && out.st_ino == in.st_ino;
}

enum status outfile_not_read(const char *path, const char *input, struct errinfo *e)
{
    return input == NULL || !is_same(path, input)
               ? ST_OK
               : errinfo_set(e, ST_EEXISTS,
                             "%.160s is a file that this command reads: it is never "
                             "replaced; choose another name",
                             path);
}

enum status outfile_may(const char *path, bool force, struct errinfo *e)
{
    const char *const slash = strrchr(path, '/');
    struct stat named, there;

    if ((slash != NULL && slash[1] == '\0') ||
        (stat(path, &there) == 0 && S_ISDIR(there.st_mode)))
        return errinfo_set(e, ST_EINVAL, "%.160s: a folder, not a file: name a file",
                           path);
    if (lstat(path, &named) != 0)
        return ST_OK; /* or writing it will report why not */
    if (stat(path, &there) == 0 && !S_ISREG(there.st_mode))
        return errinfo_set(e, ST_EEXISTS,
                           "%.160s: not a regular file, therefore not replaced", path);
    return force
               ? ST_OK
               : errinfo_set(e, ST_EEXISTS,
                             "%.160s: the file exists: use --force to replace it", path);
}

static enum status outfile_fail(struct errinfo *e, const char *name)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "%.120s: %s", name, strerror(errno));
}

/* ---- standard output */

void outfile_wait(void)
{
    const int flags = fcntl(STDOUT_FILENO, F_GETFL);

    if (flags >= 0 && (flags & O_NONBLOCK) != 0)
        (void)fcntl(STDOUT_FILENO, F_SETFL, flags & ~O_NONBLOCK);
}

bool outfile_flush(FILE *to)
{
    return fflush(to) == 0 && !ferror(to);
}

/* ---- writing */

enum status outfile_write(const char *path, bool force, newfile_writer *write,
                          const void *arg, struct errinfo *e)
{
    const char *const slash = path != NULL ? strrchr(path, '/') : NULL;
    struct newfile file = NEWFILE_NONE;
    char folder[PATH_MAX] = ".";
    enum status st;

    if (path == NULL) {
        st = write(stdout, arg, e);
        return st == ST_OK && !outfile_flush(stdout)
                   ? errinfo_set(e, ST_EIO, "standard output cannot be written")
                   : st;
    }
    if (slash != NULL)
        (void)snprintf(folder, sizeof folder, "%.*s", (int)(slash - path) + 1, path);
    if (mkdir(folder, 0700) != 0 && errno != EEXIST)
        return outfile_fail(e, folder);
    st = newfile_open(path, &file, e);
    if (st == ST_OK && (st = newfile_fill(&file, write, arg, e)) == ST_OK)
        st = force ? newfile_commit(&file, e) : newfile_keep(&file, e);
    newfile_close(&file);
    return st;
}
