#define _GNU_SOURCE /* renameat2() */
#include "newfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"

int newfile_open_directory(const char *path)
{
    char dir[PATH_MAX];
    const char *slash = strrchr(path, '/');

    (void)snprintf(dir, sizeof dir, "%.*s",
                   slash == NULL   ? 1
                   : slash == path ? 1
                                   : (int)(slash - path),
                   slash == NULL ? "." : path);
    return open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

int newfile_sync_directory(const char *path)
{
    const int fd = newfile_open_directory(path);
    int rc;

    if (fd < 0)
        return -1;
    rc = fsync(fd);
    (void)close(fd);
    return rc;
}

static enum status fail(const struct newfile *n, const char *what, struct errinfo *e)
{
    return errinfo_set(e, ST_EIO, "cannot %s %.160s: %s", what, n->path, strerror(errno));
}

/* The part is ours while it is locked and still has its name: another process may have
 * given it the other name between our opening and our locking it; or both, and have been
 * killed before it took this one away. */
static enum status open_part(struct newfile *n, struct errinfo *e)
{
    struct stat ours, named;

    for (;;) {
        n->fd = open(n->part, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (n->fd < 0)
            return fail(n, "create", e);
        if (flock(n->fd, LOCK_EX | LOCK_NB) != 0) {
            const int err = errno;

            (void)close(n->fd);
            n->fd = -1;
            if (err == EWOULDBLOCK)
                return errinfo_set(e, ST_EBUSY, "another process writes %.160s", n->path);
            errno = err;
            return fail(n, "create", e);
        }
        if (fstat(n->fd, &ours) == 0 && stat(n->part, &named) == 0 &&
            ours.st_ino == named.st_ino && ours.st_dev == named.st_dev) {
            if (ours.st_nlink == 1)
                break;
            (void)unlink(n->part);
        }
        (void)close(n->fd);
    }
    if (fchmod(n->fd, 0600) != 0 || ftruncate(n->fd, 0) != 0)
        return fail(n, "write", e);
    return ST_OK;
}

enum status newfile_open(const char *path, struct newfile *n, struct errinfo *e)
{
    const size_t len = strlen(path) + sizeof ".part";
    enum status st;

    n->fd = -1;
    n->path = strdup(path);
    if ((n->part = malloc(len)) == NULL || n->path == NULL) {
        newfile_close(n);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    (void)snprintf(n->part, len, "%s.part", path);
    if ((st = open_part(n, e)) != ST_OK)
        newfile_close(n);
    return st;
}

/* The part has got its name, or another one: it is no part any more. */
static enum status named(struct newfile *n, struct errinfo *e)
{
    (void)close(n->fd);
    n->fd = -1;
    return newfile_sync_directory(n->path) == 0 ? ST_OK : fail(n, "write", e);
}

enum status newfile_commit(struct newfile *n, struct errinfo *e)
{
    if (fsync(n->fd) != 0 || rename(n->part, n->path) != 0)
        return fail(n, "write", e);
    return named(n, e);
}

/* In one step, where the file system can: else a process that is killed leaves two names. */
static int rename_new(const char *from, const char *to)
{
    if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0)
        return 0;
    if ((errno != EINVAL && errno != ENOSYS) || link(from, to) != 0)
        return -1;
    (void)unlink(from);
    return 0;
}

enum status newfile_keep(struct newfile *n, struct errinfo *e)
{
    if (fsync(n->fd) != 0)
        return fail(n, "write", e);
    if (rename_new(n->part, n->path) != 0)
        return errno == EEXIST
                   ? errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", n->path)
                   : fail(n, "write", e);
    return named(n, e);
}

void newfile_close(struct newfile *n)
{
    if (n->fd >= 0) {
        (void)unlink(n->part);
        (void)close(n->fd);
    }
    n->fd = -1;
    free(n->path);
    free(n->part);
    n->path = n->part = NULL;
}
