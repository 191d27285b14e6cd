#include "ctl_dir.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lattice.h"
#include "mesh.h"

static enum status fail(struct errinfo *e, const char *name)
{
    const enum status st = errno == EACCES || errno == EPERM ? ST_EDENIED : ST_EIO;

    return errinfo_set(e, st, "%.120s: %s", name, strerror(errno));
}

enum status ctl_dir_open(const char *path, int *dir, struct errinfo *e)
{
    *dir = -1;
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return fail(e, path);
    *dir = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return *dir >= 0 ? ST_OK : fail(e, path);
}

enum status ctl_dir_write(int dir, const char *name, newfile_writer *write,
                          const void *arg, struct errinfo *e)
{
    struct newfile file = NEWFILE_NONE;
    enum status st;

    if ((st = newfile_open_at(dir, name, &file, e)) == ST_OK &&
        (st = newfile_fill(&file, write, arg, e)) == ST_OK)
        st = newfile_commit(&file, e);
    newfile_close(&file);
    return st;
}

enum status ctl_dir_remove(int dir, const char *name, struct errinfo *e)
{
    return unlinkat(dir, name, 0) == 0 || errno == ENOENT ? ST_OK : fail(e, name);
}

enum status ctl_dir_may_write(const char *path, bool force, char *const *input,
                              size_t ninput, struct errinfo *e)
{
    struct stat there, read;

    if (stat(path, &there) != 0)
        return ST_OK; /* or the writing says why not */
    for (size_t i = 0; i < ninput; i++)
        if (stat(input[i], &read) == 0 && read.st_dev == there.st_dev &&
            read.st_ino == there.st_ino)
            return errinfo_set(
                e, ST_EEXISTS,
                "%.160s is a file that this command reads: it is not replaced", path);
    return force ? ST_OK
                 : errinfo_set(e, ST_EEXISTS, "%.160s exists: --force replaces it", path);
}

/* A mesh as PLY, its coordinates to the last digit of the lattice. */
static enum status write_mesh(FILE *to, const void *arg, struct errinfo *e)
{
    const struct mesh *m = arg;

    (void)e;
    (void)fprintf(
        to,
        "ply\nformat ascii 1.0\ncomment mm\nelement vertex %u\n"
        "property float x\nproperty float y\nproperty float z\n"
        "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
        m->nv, mesh_real(m));
    for (uint32_t v = 0; v < m->nv; v++)
        (void)fprintf(to, "%.3f %.3f %.3f\n", m->xy[v].x / LATTICE_PER_MM,
                      m->xy[v].y / LATTICE_PER_MM, m->z[v] / LATTICE_PER_MM);
    for (uint32_t t = 0; t < m->nt; t++)
        if (!mesh_is_ghost(m, t))
            (void)fprintf(to, "3 %u %u %u\n", m->org[3 * t], m->org[3 * t + 1],
                          m->org[3 * t + 2]);
    return ST_OK;
}

enum status ctl_dir_file(const char *path, newfile_writer *write, const void *arg,
                         struct errinfo *e)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash != NULL ? slash + 1 : path;
    char *folder = strndup(slash != NULL ? path : "./",
                           slash != NULL ? (size_t)(slash - path) + 1 : 2);
    enum status st = ST_OK;
    int dir = -1;

    if (folder == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if (*name == '\0')
        st = errinfo_set(e, ST_EINVAL, "a folder, not a file: %.80s", path);
    if (st == ST_OK)
        st = ctl_dir_open(folder, &dir, e);
    if (st == ST_OK)
        st = ctl_dir_write(dir, name, write, arg, e);
    if (dir >= 0)
        (void)close(dir);
    free(folder);
    return st;
}

enum status ctl_dir_mesh(const char *path, const struct mesh *m, struct errinfo *e)
{
    return ctl_dir_file(path, write_mesh, m, e);
}
