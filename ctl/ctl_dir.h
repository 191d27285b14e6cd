/* ctl_dir.h -- a folder of results: files that are there whole or not at all, and
 * readable by their owner alone, since they are biometric data. */
#ifndef CTL_DIR_H
#define CTL_DIR_H
#include <stdbool.h>
#include <stddef.h>
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

/* ctl_dir_may_write(path, force, input, ninput, e): may a file be written at path?  To be asked
 * before anything is computed.  ST_EEXISTS: there is one, and no force; or it is one of those
 * that the command reads, by whatever name ("-" is none), which is never replaced. */
enum status ctl_dir_may_write(const char *path, bool force, char *const *input,
                              size_t ninput, struct errinfo *e);

/* ctl_dir_file(path, write, arg, e): the same for a path; its folder is made if it is
 * missing.
 * ctl_dir_mesh(path, m, e): a mesh there, PLY in millimetres. */
enum status ctl_dir_file(const char *path, newfile_writer *write, const void *arg,
                         struct errinfo *e);
enum status ctl_dir_mesh(const char *path, const struct mesh *m, struct errinfo *e);

/* ctl_dir_remove(dir, name, e): of a former run, where there is one. */
enum status ctl_dir_remove(int dir, const char *name, struct errinfo *e);

#endif
