/* ctl_dir.h -- a folder of results: files that are there whole or not at all, and
 * readable by their owner alone, since they are biometric data. */
#ifndef CTL_DIR_H
#define CTL_DIR_H
#include "errinfo.h"
#include "newfile.h"

struct mesh; /* mesh.h */

/* ctl_dir_open(path, dir, e): make the folder, unless it is there, and open it; *dir
 * is closed by the caller.  ST_EIO, ST_EDENIED. */
enum status ctl_dir_open(const char *path, int *dir, struct errinfo *e);

/* ctl_dir_write(dir, name, write, arg, e): a file with what write(to, arg, e) writes;
 * one of that name is replaced.  write need not look at write errors; when it fails, or not
 * everything could be written, nothing has changed. */
enum status ctl_dir_write(int dir, const char *name, newfile_writer *write,
                          const void *arg, struct errinfo *e);

/* ctl_dir_file(path, write, arg, e): the same for a path; its folder is made if it is
 * missing.
 * ctl_dir_mesh(path, m, e): a mesh there, PLY in millimetres. */
enum status ctl_dir_file(const char *path, newfile_writer *write, const void *arg,
                         struct errinfo *e);
enum status ctl_dir_mesh(const char *path, const struct mesh *m, struct errinfo *e);

/* ctl_dir_remove(dir, name, e): of a former run, where there is one. */
enum status ctl_dir_remove(int dir, const char *name, struct errinfo *e);

#endif
