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

#define LINKS 40 /* as many as the kernel follows */

int newfile_open_directory(const char *path)
{
    char name[PATH_MAX];
    const char *slash = strrchr(path, '/');

    (void)snprintf(name, sizeof name, "%.*s",
                   slash == NULL   ? 1
                   : slash == path ? 1
                                   : (int)(slash - path),
                   slash == NULL ? "." : path);
    return open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

/* A file system that has no flush of a folder (EINVAL) keeps its names in order by itself. */
bool newfile_sync_directory(int folder)
{
    return fsync(folder) == 0 || errno == EINVAL;
}

/* The name that the link at *path has for its target; relative ones are so to the link's folder.  false: it
 * is no link, or (errno is not 0) cannot be read. */
static bool follow(char **path)
{
    const char *slash = strrchr(*path, '/');
    const size_t folder = slash != NULL ? (size_t)(slash - *path) + 1 : 0;
    char to[PATH_MAX], *next;
    const ssize_t n = readlink(*path, to, sizeof to - 1);
    size_t size;

    if (n < 0 && (errno == EINVAL || errno == ENOENT || errno == ENOTDIR))
        errno = 0;
    if (n < 0)
        return false;
    to[n] = '\0';
    size = folder + (size_t)n + 1;
    if ((next = malloc(size)) == NULL)
        return false;
    (void)snprintf(next, size, "%.*s%s", to[0] == '/' ? 0 : (int)folder, *path, to);
    free(*path);
    *path = next;
    return true;
}

enum status newfile_beside(const char *path, const char *suffix, char **out,
                           struct errinfo *e)
{
    char *at = strdup(path);
    size_t size;
    int links = 0;

    *out = NULL;
    while (at != NULL && links < LINKS && follow(&at))
        links++;
    if (links == LINKS)
        errno = ELOOP;
    if (at != NULL && errno == 0) {
        size = strlen(at) + strlen(suffix) + 1;
        if ((*out = malloc(size)) != NULL)
            (void)snprintf(*out, size, "%s%s", at, suffix);
    }
    free(at);
    return *out != NULL ? ST_OK
                        : errinfo_set(e, errno == ENOMEM ? ST_ENOMEM : ST_EIO,
                                      "cannot follow the links of %.160s: %s", path,
                                      strerror(errno));
}

bool newfile_missing(const char *path)
{
    return access(path, F_OK) != 0 && (errno == ENOENT || errno == ENOTDIR);
}

static enum status newfile_fail(const struct newfile *n, const char *what,
                                struct errinfo *e)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "cannot %s %.160s: %s", what, n->path, strerror(errno));
}

/* Does the part still have its name? */
static bool is_named(const struct newfile *n)
{
    struct stat ours, named;

    return fstat(n->fd, &ours) == 0 && lstat(n->part, &named) == 0 &&
           ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
}

/* Lock n->fd; the part is ours while it is locked and has its name, which another process may
 * have changed between our opening and our locking it.  *ours: is it? */
static enum status lock_part(struct newfile *n, bool *ours, struct errinfo *e)
{
    const bool locked = flock(n->fd, LOCK_EX | LOCK_NB) == 0;
    enum status st = ST_OK;

    if (!locked)
        st = errno == EWOULDBLOCK
                 ? errinfo_set(e, ST_EBUSY,
                               "%.160s: another process is writing it: try again later",
                               n->path)
                 : newfile_fail(n, "create", e);
    *ours = locked && is_named(n);
    if (!*ours) {
        (void)close(n->fd);
        n->fd = -1;
    }
    return st;
}

/* Whatever has the part's name: what a run of this user has left that was killed is removed.
 * Others may have put anything there, for us to write into or through. */
static enum status remove_left(struct newfile *n, struct errinfo *e)
{
    struct stat sb;
    bool ours;
    enum status st;

    if (lstat(n->part, &sb) != 0)
        return errno == ENOENT ? ST_OK : newfile_fail(n, "create", e);
    if (!S_ISREG(sb.st_mode) || sb.st_uid != geteuid() || (sb.st_mode & 077) != 0)
        return errinfo_set(
            e, ST_EDENIED,
            "%.160s exists and was not left by an earlier run of this user (owner %u, "
            "mode %03o): remove it",
            n->part, (unsigned)sb.st_uid, (unsigned)(sb.st_mode & 0777));
    n->fd = open(n->part, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (n->fd < 0)
        return errno == ENOENT ? ST_OK : newfile_fail(n, "create", e);
    if ((st = lock_part(n, &ours, e)) != ST_OK || !ours)
        return st;
    (void)unlink(n->part);
    (void)close(n->fd);
    n->fd = -1;
    return ST_OK;
}

static enum status open_part(struct newfile *n, struct errinfo *e)
{
    const int flags = O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW;
    bool ours = false;
    enum status st;

    while (!ours) {
        n->fd = open(n->part, flags, 0600);
        if (n->fd < 0 && errno != EEXIST)
            return newfile_fail(n, "create", e);
        st = n->fd < 0 ? remove_left(n, e) : lock_part(n, &ours, e);
        if (st != ST_OK)
            return st;
    }
    return fchmod(n->fd, 0600) == 0 ? ST_OK : newfile_fail(n, "write", e);
}

enum status newfile_open(const char *path, struct newfile *n, struct errinfo *e)
{
    const size_t len = strlen(path) + sizeof ".part";
    enum status st;

    n->fd = n->folder = -1;
    n->path = strdup(path);
    if ((n->part = malloc(len)) == NULL || n->path == NULL) {
        newfile_close(n);
        return errinfo_memory(e);
    }
    (void)snprintf(n->part, len, "%s.part", path);
    if ((n->folder = newfile_open_directory(path)) < 0)
        st = newfile_fail(n, "open the folder of", e);
    else
        st = open_part(n, e);
    if (st != ST_OK)
        newfile_close(n);
    return st;
}

enum status newfile_put(struct newfile *n, const void *data, size_t len,
                        struct errinfo *e)
{
    const char *at = data;

    while (len > 0) {
        const ssize_t done = write(n->fd, at, len);

        if (done < 0 && errno != EINTR)
            return newfile_fail(n, "write", e);
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
        st = newfile_fail(n, "write", e);
        if (fd >= 0)
            (void)close(fd);
        return st;
    }
    st = write_to(to, arg, e);
    whole = fflush(to) == 0 && !ferror(to);
    whole = fclose(to) == 0 && whole;
    return st == ST_OK && !whole ? newfile_fail(n, "write", e) : st;
}

/* The part was renamed: it is no part any more. */
static enum status named(struct newfile *n, struct errinfo *e)
{
    (void)close(n->fd);
    n->fd = -1;
    return newfile_sync_directory(n->folder)
               ? ST_OK
               : errinfo_set(e, ST_EUNSYNCED,
                             "%.160s is written, but its folder cannot be flushed to the "
                             "disk (%s): a power failure may remove it",
                             n->path, strerror(errno));
}

void newfile_like(int fd, const char *path)
{
    struct stat sb;

    if (stat(path, &sb) == 0 && fchown(fd, sb.st_uid, sb.st_gid) == 0)
        (void)fchmod(fd, 0600 | (sb.st_mode & 0040));
}

enum status newfile_sync(const struct newfile *n, struct errinfo *e)
{
    if (fsync(n->fd) != 0)
        return newfile_fail(n, "write", e);
    return is_named(n)
               ? ST_OK
               : errinfo_set(e, ST_EIO,
                             "%.160s was removed or replaced while it was written",
                             n->part);
}

enum status newfile_commit(struct newfile *n, struct errinfo *e)
{
    const enum status st = newfile_sync(n, e);

    if (st != ST_OK)
        return st;
    if (rename(n->part, n->path) != 0)
        return newfile_fail(n, "write", e);
    return named(n, e);
}

/* In one step if the file system supports it.  If it does not, a process that is killed between
 * the two steps leaves both names. */
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
    const enum status st = newfile_sync(n, e);

    if (st != ST_OK)
        return st;
    if (rename_new(n->part, n->path) != 0)
        return errno == EEXIST
                   ? errinfo_set(e, ST_EEXISTS, "%.160s: the file exists", n->path)
                   : newfile_fail(n, "write", e);
    return named(n, e);
}

enum status newfile_rename(const char *from, const char *to, struct errinfo *e)
{
    const int folder = newfile_open_directory(to);
    enum status st = ST_OK;

    if (folder < 0 || rename_new(from, to) != 0)
        st = errinfo_set(e, errno == EEXIST ? ST_EEXISTS : ST_EIO,
                         "cannot rename %.150s to %.150s: %s", from, to, strerror(errno));
    else if (!newfile_sync_directory(folder))
        st = errinfo_set(e, ST_EUNSYNCED,
                         "%.120s is now %.120s, but its folder cannot be flushed to the "
                         "disk (%s): a power failure may undo that",
                         from, to, strerror(errno));
    if (folder >= 0)
        (void)close(folder);
    return st;
}

void newfile_leave(struct newfile *n)
{
    if (n->fd >= 0)
        (void)close(n->fd);
    if (n->folder >= 0)
        (void)close(n->folder);
    n->fd = n->folder = -1;
    free(n->path);
    free(n->part);
    n->path = n->part = NULL;
}

void newfile_close(struct newfile *n)
{
    if (n->fd >= 0 && is_named(n))
        (void)unlink(n->part);
    newfile_leave(n);
}
