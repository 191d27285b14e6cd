#include "ctl_dir.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cloudply.h"
#include "ctl_command.h"

static enum status fail(struct errinfo *e, const char *name)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "%.120s: %s", name, strerror(errno));
}

static enum status open_folder(const char *path, int *dir, struct errinfo *e)
{
    *dir = -1;
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return fail(e, path);
    *dir = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return *dir >= 0 ? ST_OK : fail(e, path);
}

static enum status write_file(int dir, const char *name, bool replace,
                              newfile_writer *write, const void *arg, struct errinfo *e)
{
    struct newfile file = NEWFILE_NONE;
    enum status st;

    if ((st = newfile_open_at(dir, name, &file, e)) == ST_OK &&
        (st = newfile_fill(&file, write, arg, e)) == ST_OK)
        st = replace ? newfile_commit(&file, e) : newfile_keep(&file, e);
    newfile_close(&file);
    return st;
}

/* ---- may it be written? */

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

static enum status not_read(struct ctl *c, const char *path, const char *input)
{
    return input == NULL || !is_same(path, input)
               ? ST_OK
               : errinfo_set(&c->e, ST_EEXISTS,
                             "%.160s is a file that this command reads: it is never "
                             "replaced; choose another name",
                             path);
}

/* None of the shared options' files, nor what belongs to the database. */
static enum status not_shared(struct ctl *c, const char *path)
{
    static const char *const beside[] = {"-wal", "-shm", ".key", ".key.anchor",
                                         ".anchor"};
    const char *const given[] = {c->db,     c->config,     c->key,
                                 c->anchor, c->model_path, c->archive_key};
    char name[PATH_MAX];
    enum status st = ST_OK;

    for (size_t i = 0; st == ST_OK && i < sizeof given / sizeof *given; i++)
        st = not_read(c, path, given[i]);
    for (size_t i = 0; st == ST_OK && i < 2 * sizeof beside / sizeof *beside; i++) {
        const char *const of = i % 2 == 0 ? c->db : c->key;

        (void)snprintf(name, sizeof name, "%s%s", of != NULL ? of : "", beside[i / 2]);
        st = not_read(c, path, of != NULL ? name : NULL);
    }
    return st;
}

static bool is_standard(const char *path)
{
    return strcmp(path, "-") == 0;
}

enum status ctl_dir_may_write(struct ctl *c, const char *path, int nread)
{
    const char *const slash = strrchr(path, '/');
    struct stat named, there;
    enum status st = ST_OK;

    if (is_standard(path))
        return ctl_usage(c,
                         "%s cannot write to standard output: name a file (./- is one)",
                         c->cmd->name);
    for (int i = 0; st == ST_OK && i < nread; i++)
        st = not_read(c, path, c->args[i]);
    if (st != ST_OK || (st = not_shared(c, path)) != ST_OK)
        return st;
    if ((slash != NULL && slash[1] == '\0') ||
        (stat(path, &there) == 0 && S_ISDIR(there.st_mode)))
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

enum status ctl_dir_may_pipe(struct ctl *c, int nread)
{
    if (!is_standard(c->dir))
        return ctl_dir_may_write(c, c->dir, nread);
    if (c->json)
        return ctl_usage(c,
                         "--out - and --json both write to standard output: name a file");
    c->piped = true;
    return ST_OK;
}

/* ---- a file */

static enum status write_mesh(FILE *to, const void *m, struct errinfo *e)
{
    (void)e;
    cloudply_write(to, m);
    return ST_OK;
}

static enum status write_out(newfile_writer *write, const void *arg, struct errinfo *e)
{
    const enum status st = write(stdout, arg, e);

    return st == ST_OK && fflush(stdout) != 0
               ? errinfo_set(e, ST_EIO, "standard output: %s", strerror(errno))
               : st;
}

enum status ctl_dir_file(struct ctl *c, const char *path, newfile_writer *write,
                         const void *arg)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    char *folder;
    enum status st;
    int dir = -1;

    if (c->piped)
        return write_out(write, arg, &c->e);
    if ((folder = strndup(slash != NULL ? path : "./",
                          slash != NULL ? (size_t)(slash - path) + 1 : 2)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if ((st = open_folder(folder, &dir, &c->e)) == ST_OK)
        st = write_file(dir, name, c->force, write, arg, &c->e);
    if (dir >= 0)
        (void)close(dir);
    free(folder);
    return st;
}

enum status ctl_dir_mesh(struct ctl *c, const char *path, const struct mesh *m)
{
    return ctl_dir_file(c, path, write_mesh, m);
}
