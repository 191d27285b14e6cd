#define _GNU_SOURCE /* renameat2() */
#include "newfile.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"

/* The folder of a file, whose name is relative to dir. */
static int open_directory(int dir, const char *path)
{
    char name[PATH_MAX];
    const char *slash = strrchr(path, '/');

    (void)snprintf(name, sizeof name, "%.*s",
                   slash == NULL   ? 1
                   : slash == path ? 1
                                   : (int)(slash - path),
                   slash == NULL ? "." : path);
    return openat(dir, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

static int sync_directory(int dir, const char *path)
{
    const int fd = open_directory(dir, path);
    int rc;

    if (fd < 0)
        return -1;
    rc = fsync(fd);
    (void)close(fd);
    return rc;
}

int newfile_open_directory(const char *path)
{
    return open_directory(AT_FDCWD, path);
}

int newfile_sync_directory(const char *path)
{
    return sync_directory(AT_FDCWD, path);
}

static enum status fail(const struct newfile *n, const char *what, struct errinfo *e)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "cannot %s %.160s: %s", what, n->path, strerror(errno));
}

/* The part is ours while it is locked and still has its name: another process may have
 * given it the other name between our opening and our locking it; or both, and have been
 * killed before it took this one away. */
static enum status open_part(struct newfile *n, struct errinfo *e)
{
    struct stat ours, named;

    for (;;) {
        n->fd = openat(n->dir, n->part, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
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
        if (fstat(n->fd, &ours) == 0 && fstatat(n->dir, n->part, &named, 0) == 0 &&
            ours.st_ino == named.st_ino && ours.st_dev == named.st_dev) {
            if (ours.st_nlink == 1)
                break;
            (void)unlinkat(n->dir, n->part, 0);
        }
        (void)close(n->fd);
    }
    if (fchmod(n->fd, 0600) != 0 || ftruncate(n->fd, 0) != 0)
        return fail(n, "write", e);
    return ST_OK;
}

enum status newfile_open_at(int dir, const char *name, struct newfile *n,
                            struct errinfo *e)
{
    const size_t len = strlen(name) + sizeof ".part";
    enum status st;

    n->fd = -1;
    n->dir = dir;
    n->path = strdup(name);
    if ((n->part = malloc(len)) == NULL || n->path == NULL) {
        newfile_close(n);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    (void)snprintf(n->part, len, "%s.part", name);
    if ((st = open_part(n, e)) != ST_OK)
        newfile_close(n);
    return st;
}

enum status newfile_open(const char *path, struct newfile *n, struct errinfo *e)
{
    return newfile_open_at(AT_FDCWD, path, n, e);
}

enum status newfile_put(struct newfile *n, const void *data, size_t len,
                        struct errinfo *e)
{
    const char *at = data;

    while (len > 0) {
        const ssize_t done = write(n->fd, at, len);

        if (done < 0 && errno != EINTR)
            return fail(n, "write", e);
        at += done > 0 ? done : 0;
        len -= done > 0 ? (size_t)done : 0;
    }
    return ST_OK;
}

enum status newfile_fill(struct newfile *n, newfile_writer *write_to, const void *arg,
                         struct errinfo *e)
{
    const int fd = fcntl(n->fd, F_DUPFD_CLOEXEC, 0);
    FILE *to = fd < 0 ? NULL : fdopen(fd, "wb");
    enum status st;
    bool whole;

    if (to == NULL) {
        st = fail(n, "write", e);
        if (fd >= 0)
            (void)close(fd);
        return st;
    }
    st = write_to(to, arg, e);
    whole = fflush(to) == 0 && !ferror(to);
    whole = fclose(to) == 0 && whole;
    return st == ST_OK && !whole ? fail(n, "write", e) : st;
}

/* The part was renamed: it is no part any more. */
static enum status named(struct newfile *n, struct errinfo *e)
{
    (void)close(n->fd);
    n->fd = -1;
    return sync_directory(n->dir, n->path) == 0 ? ST_OK : fail(n, "write", e);
}

enum status newfile_commit(struct newfile *n, struct errinfo *e)
{
    if (fsync(n->fd) != 0 || renameat2(n->dir, n->part, n->dir, n->path, 0) != 0)
        return fail(n, "write", e);
    return named(n, e);
}

/* In one step where the file system supports it; else a process that is killed between
 * the two leaves both names. */
static int rename_new(const struct newfile *n)
{
    if (renameat2(n->dir, n->part, n->dir, n->path, RENAME_NOREPLACE) == 0)
        return 0;
    if ((errno != EINVAL && errno != ENOSYS) ||
        linkat(n->dir, n->part, n->dir, n->path, 0) != 0)
        return -1;
    (void)unlinkat(n->dir, n->part, 0);
    return 0;
}

enum status newfile_keep(struct newfile *n, struct errinfo *e)
{
    if (fsync(n->fd) != 0)
        return fail(n, "write", e);
    if (rename_new(n) != 0)
        return errno == EEXIST
                   ? errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", n->path)
                   : fail(n, "write", e);
    return named(n, e);
}

void newfile_close(struct newfile *n)
{
    if (n->fd >= 0) {
        (void)unlinkat(n->dir, n->part, 0);
        (void)close(n->fd);
    }
    n->fd = -1;
    free(n->path);
    free(n->part);
    n->path = n->part = NULL;
}
