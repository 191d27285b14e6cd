#include "ctl_dir.h"

#include <stdio.h>
#include <string.h>

#include "cloudwrite.h"
#include "ctl_command.h"
#include "outfile.h"

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
        st = outfile_not_read(path, given[i], &c->e);
    for (size_t i = 0; st == ST_OK && i < 2 * sizeof beside / sizeof *beside; i++) {
        const char *const of = i % 2 == 0 ? c->db : c->key;

        (void)snprintf(name, sizeof name, "%s%s", of != NULL ? of : "", beside[i / 2]);
        st = outfile_not_read(path, of != NULL ? name : NULL, &c->e);
    }
    return st;
}

static bool is_standard(const char *path)
{
    return strcmp(path, "-") == 0;
}

enum status ctl_dir_may_write(struct ctl *c, const char *path, int nread)
{
    enum status st = ST_OK;

    if (is_standard(path))
        return ctl_usage(c,
                         "%s cannot write to standard output: name a file (./- is one)",
                         c->cmd->name);
    for (int i = 0; st == ST_OK && i < nread; i++)
        st = outfile_not_read(path, c->args[i], &c->e);
    if (st == ST_OK)
        st = not_shared(c, path);
    return st == ST_OK ? outfile_may(path, c->force, &c->e) : st;
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

enum status ctl_dir_file(struct ctl *c, const char *path, newfile_writer *write,
                         const void *arg)
{
    return outfile_write(c->piped ? NULL : path, c->force, write, arg, &c->e);
}

enum status ctl_dir_face(struct ctl *c, const char *path, const struct surface_face *f)
{
    return ctl_dir_file(c, path, cloudwrite_ply, f);
}
