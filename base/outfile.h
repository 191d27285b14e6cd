/* outfile.h -- the rules of files that a command writes: they are there whole or not at all,
 * readable by their owner alone; a file that exists is replaced with --force alone, a file that
 * the command reads never. */
#ifndef BASE_OUTFILE_H
#define BASE_OUTFILE_H
#include <stdbool.h>
#include <stdio.h>
#include "newfile.h"
#include "status.h"

struct errinfo; /* errinfo.h */

/* outfile_not_read(path, input, e): ST_EEXISTS if both are one file, by whatever name (a link,
 * another path), or input is PATH.part, which is written first.  input may be NULL or missing.
 * outfile_may(path, force, e): may a file be written there?  ST_EEXISTS: it exists, and force is
 * false, or it is no regular file; ST_EINVAL: a folder. */
enum status outfile_not_read(const char *path, const char *input, struct errinfo *e);
enum status outfile_may(const char *path, bool force, struct errinfo *e);

/* outfile_write(path, force, write, arg, e): a file with what write(to, arg, e) writes; its folder
 * is made if it is missing.  path NULL: standard output.  ST_EEXISTS: a file of that name has come
 * in the meantime, and force is false.  write need not look at write errors; when it fails, or
 * not everything could be written, nothing has changed.  ST_EIO, ST_EDENIED, ST_ENOMEM. */
enum status outfile_write(const char *path, bool force, newfile_writer *write,
                          const void *arg, struct errinfo *e);

/* outfile_wait(): Makes standard output blocking if another process has made it non-blocking, since stdio
 * would lose bytes while the reader is slow.  The caller calls it before the first output. */
void outfile_wait(void);

/* outfile_flush(to): Writes out all that was printed to `to`.  Returns true if no byte was lost, neither
 * now nor before: fflush() alone does not tell of an earlier failure. */
bool outfile_flush(FILE *to);

#endif
