/* ctl_dir.h -- the files that a command writes: they are there whole or not at all, and readable
 * by their owner alone, since they are biometric data.  One rule holds for all of them: a file
 * that exists is replaced with --force alone, and one that the command reads is never. */
#ifndef CTL_DIR_H
#define CTL_DIR_H
#include <stdbool.h>
#include <stddef.h>
#include "errinfo.h"
#include "newfile.h"

struct ctl;          /* ctl.h */
struct surface_face; /* libsurface.h */

/* ---- before anything is computed: may the command write there?  Failures are in c->e.
 *
 * ctl_dir_may_write(c, path, nread): a file at path.  It is compared with those that the command
 * reads: its first nread arguments ("-" and what does not exist are none), and the shared
 * options' (the database and what belongs to it, keys, model, configuration).
 * ST_EEXISTS: it is one of them, by whatever name (a link, another path); or it exists, and
 * there is no --force; or it is no regular file.  ST_EINVAL: "-", or a folder.
 * ctl_dir_may_pipe(c, nread): the same of --out, which may be "-", standard output:
 * c->piped is set then; ST_EINVAL with --json. */
enum status ctl_dir_may_write(struct ctl *c, const char *path, int nread);
enum status ctl_dir_may_pipe(struct ctl *c, int nread);

/* ---- writing */

/* ctl_dir_file(c, path, write, arg): a file with what write(to, arg, e) writes, to standard output
 * if c->piped; its folder is made if it is missing.  ST_EEXISTS: a file of that name has come in the
 * meantime, and there is no --force.  write need not look at write errors; when it fails, or not
 * everything could be written, nothing has changed.
 * ctl_dir_face(c, path, f): a face there, PLY in millimetres. */
enum status ctl_dir_file(struct ctl *c, const char *path, newfile_writer *write,
                         const void *arg);
enum status ctl_dir_face(struct ctl *c, const char *path, const struct surface_face *f);

#endif
