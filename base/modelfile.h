/* modelfile.h -- reads a model (libsurface.h) from a file and writes one. */
#ifndef BASE_MODELFILE_H
#define BASE_MODELFILE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo;
struct surface_model; /* libsurface.h */

#define MODELFILE_MAX ((size_t)8 << 20) /* bytes; a full model has about 1.5 million */

/* modelfile_read(path, out, e): *out is a new model, for surface_model_free(); NULL on failure.
 * Only a regular file is read.  e names the file, and the line where that is known.
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO; ST_EINVAL no regular file; ST_ESIZE too large;
 * ST_ECORRUPT damaged; ST_EVERSION of another version; ST_ENOMEM. */
enum status modelfile_read(const char *path, struct surface_model **out,
                           struct errinfo *e);

/* modelfile_write(path, replace, m, e): whole, or not at all: with replace, a file that was
 * there stays until the new one is complete.  As readable as the umask says; not from two
 * threads at once.
 * Returns ST_OK; ST_EEXISTS there is a file, and replace is false; ST_EDENIED, ST_EIO;
 * ST_EBUSY another process writes it; ST_ENOMEM. */
enum status modelfile_write(const char *path, bool replace, const struct surface_model *m,
                            struct errinfo *e);

#endif
