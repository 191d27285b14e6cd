/* outfile.h -- the rules for files that a command writes: they are complete or absent, and readable only by
 * their owner.  A file that exists is replaced only with --force, a file that the command reads never. */
#ifndef BASE_OUTFILE_H
#define BASE_OUTFILE_H
#include <stdbool.h>
#include <stdio.h>
#include "newfile.h"
#include "status.h"

struct errinfo; /* errinfo.h */

/* outfile_not_read(path, input, e): Returns ST_EEXISTS if the file at path is the file input, by whatever name
 * (a link, another path), or if input is PATH.part, which is written first.
 *   input   may be NULL, or missing */
enum status outfile_not_read(const char *path, const char *input, struct errinfo *e);

/* outfile_may(path, force, e): Returns ST_OK if a file may be written at path; ST_EEXISTS: it exists, and force
 * is false, or it is no regular file; ST_EINVAL: it is a folder. */
enum status outfile_may(const char *path, bool force, struct errinfo *e);

/* outfile_write(path, force, write, arg, e): Creates a file with the output of write(to, arg, e), which need not
 * check for write errors; creates its folder if that is missing.  On failure nothing has changed.
 *   path    NULL: standard output
 * Returns ST_OK; the status of write; ST_EEXISTS: a file of that name has appeared, and force is false; ST_EIO;
 * ST_EDENIED; ST_ENOMEM. */
enum status outfile_write(const char *path, bool force, newfile_writer *write,
                          const void *arg, struct errinfo *e);

/* outfile_wait(): Makes standard output blocking if another process has made it non-blocking, since stdio
 * would lose bytes while the reader is slow.  The caller calls it before the first output. */
void outfile_wait(void);

/* outfile_flush(to): Writes out all that was printed to `to`.  Returns true if no byte was lost, neither
 * now nor before: fflush() alone does not tell of an earlier failure. */
bool outfile_flush(FILE *to);

#endif
