/* Loaded into a program (LD_PRELOAD) it writes down every change that the program makes to one folder
 * and its files, in the order in which they are made, or kills it at one: for crash.py.  It makes the
 * system calls that the C library would make; a change, its count and its line in the log are one step
 * for all threads.  The log is a sequence of struct crash_op, each followed by len bytes for CRASH_WRITE.
 * Environment: CRASH_DIR the folder (absolute, without links); CRASH_LOG where the log goes;
 * CRASH_AT=N the program is killed (SIGKILL) as it begins its N-th change, CRASH_TORN=1: where
 * that is a write, after the first half of it. */
#define _GNU_SOURCE
#undef _FORTIFY_SOURCE /* this file replaces its wrappers */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#define CRASH_NAME 64

enum crash_kind {
    CRASH_CREATE,   /* name, file: an empty file */
    CRASH_WRITE,    /* file, at, len */
    CRASH_TRUNCATE, /* file, at: its new size */
    CRASH_SYNC,     /* file */
    CRASH_SYNC_DIR,
    CRASH_RENAME, /* name, to */
    CRASH_LINK,   /* name, to */
    CRASH_UNLINK  /* name */
};

struct crash_op {
    uint32_t kind, len;
    uint64_t file; /* inode number; reused for another file after an unlink */
    uint64_t at;
    char name[CRASH_NAME], to[CRASH_NAME];
};

#define FDS_MAX 1024
#define FOLDER  UINT64_MAX /* instead of an inode */

int __open_2(const char *path, int flags);

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static const char *dir; /* NULL: nothing is recorded */
static size_t dir_len;
static unsigned long at, count;
static bool torn;
static int log_fd = -1;
static uint64_t file_of[FDS_MAX]; /* by file descriptor; 0: not in the folder */

__attribute__((constructor)) static void start(void)
{
    const char *value, *path = getenv("CRASH_LOG");

    if ((dir = getenv("CRASH_DIR")) == NULL)
        return;
    dir_len = strlen(dir);
    if ((value = getenv("CRASH_AT")) != NULL)
        at = strtoul(value, NULL, 10);
    torn = getenv("CRASH_TORN") != NULL;
    if (path != NULL &&
        (log_fd = (int)syscall(SYS_openat, AT_FDCWD, path,
                               O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) < 0)
        abort();
}

/* The name in the folder; NULL: the path is elsewhere, or is SQLite's shared memory, which the
 * next process makes again. */
static const char *name_of(const char *path)
{
    const size_t n = strlen(path);

    return dir != NULL && strncmp(path, dir, dir_len) == 0 && path[dir_len] == '/' &&
                   strchr(path + dir_len + 1, '/') == NULL &&
                   (n < 4 || strcmp(path + n - 4, "-shm") != 0)
               ? path + dir_len + 1
               : NULL;
}

static uint64_t of_fd(int fd)
{
    return fd >= 0 && fd < FDS_MAX ? file_of[fd] : 0;
}

/* Begins a change.  write: the n bytes of a write; NULL for other changes. */
static void begin(int fd, const void *write, size_t n, off_t to)
{
    (void)pthread_mutex_lock(&lock);
    if (++count != at)
        return;
    if (torn && write != NULL)
        (void)syscall(SYS_pwrite64, fd, write, n / 2, to);
    (void)kill(getpid(), SIGKILL);
}

static long end(long rc, struct crash_op *op, const char *name, const char *to,
                const void *data)
{
    const int err = errno;

    if (rc >= 0 && log_fd >= 0) {
        struct iovec out[2] = {{.iov_base = op, .iov_len = sizeof *op}};

        if (name != NULL)
            (void)snprintf(op->name, sizeof op->name, "%s", name);
        if (to != NULL)
            (void)snprintf(op->to, sizeof op->to, "%s", to);
        memcpy(&out[1].iov_base, &data, sizeof data);
        out[1].iov_len = op->len;
        if (writev(log_fd, out, 2) != (ssize_t)(sizeof *op + op->len))
            abort();
    }
    (void)pthread_mutex_unlock(&lock);
    errno = err;
    return rc;
}

/* ---- opening */

static int open_at(const char *path, int flags, mode_t mode)
{
    const char *name = name_of(path);
    struct crash_op op = {.kind = CRASH_CREATE};
    struct stat sb;
    bool made;
    int fd;

    if (name == NULL || (flags & O_ACCMODE) == O_RDONLY) {
        fd = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
        if (fd >= 0 && fd < FDS_MAX)
            file_of[fd] = dir != NULL && strcmp(path, dir) == 0 ? FOLDER : 0;
        return fd;
    }
    if ((flags & O_TRUNC) != 0)
        abort(); /* no program does so far */
    made = (flags & O_CREAT) != 0 && syscall(SYS_faccessat, AT_FDCWD, path, F_OK) != 0;
    if (made)
        begin(-1, NULL, 0, 0);
    fd = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    if (fd >= 0 && fd < FDS_MAX && fstat(fd, &sb) == 0)
        op.file = file_of[fd] = sb.st_ino;
    return made ? (int)end(fd, &op, name, NULL, NULL) : fd;
}

#define MODE(flags, mode)                                                                \
    do {                                                                                 \
        va_list args;                                                                    \
                                                                                         \
        va_start(args, flags);                                                           \
        (mode) = ((flags) & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(args, mode_t) : 0;      \
        va_end(args);                                                                    \
    } while (0)

int open(const char *path, int flags, ...)
{
    mode_t mode;

    MODE(flags, mode);
    return open_at(path, flags, mode);
}

int openat(int from, const char *path, int flags, ...)
{
    mode_t mode;

    if (from != AT_FDCWD && dir != NULL)
        abort(); /* no program does so far */
    MODE(flags, mode);
    return open_at(path, flags, mode);
}

int __open_2(const char *path, int flags)
{
    return open_at(path, flags, 0);
}

/* These do the same where off_t has 64 bits. */
#define ALIAS(name, of) extern __typeof(of) name __attribute__((alias(#of)))
ALIAS(open64, open);
ALIAS(__open64_2, __open_2);

int close(int fd)
{
    if (fd >= 0 && fd < FDS_MAX)
        file_of[fd] = 0;
    return (int)syscall(SYS_close, fd);
}

/* ---- a file's bytes */

static ssize_t write_at(int fd, const void *data, size_t n, off_t to)
{
    struct crash_op op = {CRASH_WRITE, (uint32_t)n, of_fd(fd), (uint64_t)to, "", ""};
    ssize_t rc;

    begin(fd, data, n, to);
    if ((rc = syscall(SYS_pwrite64, fd, data, n, to)) >= 0)
        op.len = (uint32_t)rc;
    return end(rc, &op, NULL, NULL, data);
}

ssize_t pwrite(int fd, const void *data, size_t n, off_t to)
{
    return of_fd(fd) != 0 ? write_at(fd, data, n, to)
                          : syscall(SYS_pwrite64, fd, data, n, to);
}

ALIAS(pwrite64, pwrite);

ssize_t write(int fd, const void *data, size_t n)
{
    ssize_t rc;

    if (of_fd(fd) == 0)
        return syscall(SYS_write, fd, data, n);
    if ((rc = write_at(fd, data, n, lseek(fd, 0, SEEK_CUR))) > 0)
        (void)lseek(fd, rc, SEEK_CUR);
    return rc;
}

int ftruncate(int fd, off_t size)
{
    struct crash_op op = {CRASH_TRUNCATE, 0, of_fd(fd), (uint64_t)size, "", ""};

    if (op.file == 0)
        return (int)syscall(SYS_ftruncate, fd, size);
    begin(fd, NULL, 0, 0);
    return (int)end(syscall(SYS_ftruncate, fd, size), &op, NULL, NULL, NULL);
}

ALIAS(ftruncate64, ftruncate);

/* Syncs need not reach the disk, since the machine itself keeps running. */
static int sync_nothing(long call, int fd)
{
    struct crash_op op = {CRASH_SYNC, 0, of_fd(fd), 0, "", ""};

    if (op.file == 0)
        return (int)syscall(call, fd);
    if (op.file == FOLDER)
        op.kind = CRASH_SYNC_DIR;
    begin(fd, NULL, 0, 0);
    return (int)end(0, &op, NULL, NULL, NULL);
}

int fsync(int fd)
{
    return sync_nothing(SYS_fsync, fd);
}

int fdatasync(int fd)
{
    return sync_nothing(SYS_fdatasync, fd);
}

/* ---- names */

static int change_name(enum crash_kind kind, unsigned flags, const char *path,
                       const char *to)
{
    struct crash_op op = {.kind = kind};
    const char *a = name_of(path), *b = to != NULL ? name_of(to) : NULL;
    const bool ours = a != NULL || b != NULL;
    long rc;

    if (ours && (a == NULL || (to != NULL && b == NULL)))
        abort(); /* from or to another folder: no program does so far */
    if (ours)
        begin(-1, NULL, 0, 0);
    if (kind == CRASH_RENAME)
        rc = syscall(SYS_renameat2, AT_FDCWD, path, AT_FDCWD, to, flags);
    else if (kind == CRASH_LINK)
        rc = syscall(SYS_linkat, AT_FDCWD, path, AT_FDCWD, to, 0);
    else
        rc = syscall(SYS_unlinkat, AT_FDCWD, path, 0);
    return (int)(ours ? end(rc, &op, a, b, NULL) : rc);
}

int rename(const char *path, const char *to)
{
    return change_name(CRASH_RENAME, 0, path, to);
}

int renameat2(int from, const char *path, int in, const char *to, unsigned flags)
{
    if (from != AT_FDCWD || in != AT_FDCWD)
        abort(); /* no program does so far */
    return change_name(CRASH_RENAME, flags, path, to);
}

int link(const char *path, const char *to)
{
    return change_name(CRASH_LINK, 0, path, to);
}

int unlink(const char *path)
{
    return change_name(CRASH_UNLINK, 0, path, NULL);
}

int unlinkat(int from, const char *path, int flags)
{
    if (from != AT_FDCWD || flags != 0)
        abort(); /* no program does so far */
    return change_name(CRASH_UNLINK, 0, path, NULL);
}
