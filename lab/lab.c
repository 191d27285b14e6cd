#include "lab.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum status lab_usage(struct lab *c, const char *fmt, ...)
{
    va_list args;

    c->code = LAB_USAGE;
    c->e.code = ST_EINVAL;
    va_start(args, fmt);
    (void)vsnprintf(c->e.msg, sizeof c->e.msg, fmt, args);
    va_end(args);
    return ST_EINVAL;
}

void lab_say(const struct lab *c, const char *fmt, ...)
{
    va_list args;

    if (c->json)
        return;
    va_start(args, fmt);
    (void)vfprintf(c->piped ? stderr : stdout, fmt, args);
    va_end(args);
}

void *lab_grow(void *list, size_t n, size_t size)
{
    return (n & (n - 1)) != 0 ? list : realloc(list, (n > 0 ? 2 * n : 1) * size);
}

const char *lab_decision(enum face_decision d)
{
    return d == FACE_MATCH ? "match" : d == FACE_NO_MATCH ? "no_match" : "inconclusive";
}

double lab_clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* ---- may a file be written? */

/* Is the input the file at path, or at "path.part", which is written first (newfile.h)? */
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

enum status lab_not_read(struct lab *c, const char *path, const char *input)
{
    return input == NULL || !is_same(path, input)
               ? ST_OK
               : errinfo_set(&c->e, ST_EEXISTS,
                             "%.160s is a file that this command reads: it is never "
                             "replaced; choose another name",
                             path);
}

enum status lab_may_write(struct lab *c, const char *path, int nread)
{
    struct stat named, there;
    enum status st = lab_not_read(c, path, c->model_path);

    if (strcmp(path, "-") == 0)
        return lab_usage(c,
                         "%s cannot write to standard output: name a file (./- is one)",
                         c->command);
    for (int i = 0; st == ST_OK && i < nread; i++)
        st = lab_not_read(c, path, c->args[i]);
    if (st != ST_OK)
        return st;
    if (stat(path, &there) == 0 && S_ISDIR(there.st_mode))
        return errinfo_set(&c->e, ST_EINVAL, "%.160s is a folder, not a file", path);
    if (lstat(path, &named) != 0)
        return ST_OK; /* or the writing says why not */
    if (stat(path, &there) == 0 && !S_ISREG(there.st_mode))
        return errinfo_set(&c->e, ST_EEXISTS,
                           "%.160s is not a regular file: it is not replaced", path);
    return c->force ? ST_OK
                    : errinfo_set(&c->e, ST_EEXISTS, "%.160s exists: --force replaces it",
                                  path);
}

enum status lab_may_pipe(struct lab *c, int nread)
{
    if (strcmp(c->out, "-") != 0)
        return lab_may_write(c, c->out, nread);
    if (c->json)
        return lab_usage(c,
                         "--out - and --json both write to standard output: name a file");
    c->piped = true;
    return ST_OK;
}

/* ---- writing */

static enum status fail(struct errinfo *e, const char *name)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "%.120s: %s", name, strerror(errno));
}

static enum status write_at(struct lab *c, int dir, const char *name,
                            newfile_writer *write, const void *arg)
{
    struct newfile file = NEWFILE_NONE;
    enum status st;

    if ((st = newfile_open_at(dir, name, &file, &c->e)) == ST_OK &&
        (st = newfile_fill(&file, write, arg, &c->e)) == ST_OK)
        st = c->force ? newfile_commit(&file, &c->e) : newfile_keep(&file, &c->e);
    newfile_close(&file);
    return st;
}

enum status lab_write_in(struct lab *c, const char *folder, const char *name,
                         newfile_writer *write, const void *arg)
{
    enum status st;
    int dir;

    if (mkdir(folder, 0700) != 0 && errno != EEXIST)
        return fail(&c->e, folder);
    if ((dir = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC)) < 0)
        return fail(&c->e, folder);
    st = write_at(c, dir, name, write, arg);
    (void)close(dir);
    return st;
}

enum status lab_write(struct lab *c, const char *path, newfile_writer *write,
                      const void *arg)
{
    const char *slash = strrchr(path, '/');
    char folder[PATH_MAX] = ".";
    enum status st;

    if (c->piped) {
        st = write(stdout, arg, &c->e);
        return st == ST_OK && fflush(stdout) != 0 ? fail(&c->e, "standard output") : st;
    }
    if (slash != NULL)
        (void)snprintf(folder, sizeof folder, "%.*s", (int)(slash - path) + 1, path);
    return lab_write_in(c, folder, slash != NULL ? slash + 1 : path, write, arg);
}
