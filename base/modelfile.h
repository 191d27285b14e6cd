/* modelfile.h -- reads a model (libsurface.h) from a file and writes one. */
#ifndef BASE_MODELFILE_H
#define BASE_MODELFILE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo;
struct surface_model; /* libsurface.h */

#define MODELFILE_MAX ((size_t)8 << 20) /* bytes; a full model has about 1.5 million */

/* modelfile_read(path, out, e): Reads the model in the file at path ("-": standard input).  The message
 * names the file, and the line if it is malformed.
 *   out     a new model, to be released by surface_model_free(); on failure: NULL
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO, ST_ENOMEM; ST_ESIZE: more than MODELFILE_MAX bytes;
 * ST_ECORRUPT: not a model, or damaged; ST_EVERSION: a model of another version. */
enum status modelfile_read(const char *path, struct surface_model **out,
                           struct errinfo *e);

/* modelfile_write(path, replace, m, e): Writes the model m to a new file, complete or not at all.  The
 * umask decides who can read the file.
 *   replace  false: does not replace a file at path
 * Threads: one at a time (it reads the umask).
 * Returns ST_OK; ST_EEXISTS: there is a file, and replace is false; ST_EDENIED, ST_EIO;
 * ST_EBUSY: another process writes the file; ST_ENOMEM. */
enum status modelfile_write(const char *path, bool replace, const struct surface_model *m,
                            struct errinfo *e);

#endif
