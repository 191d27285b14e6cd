/* readfile.h -- all of a file at once. */
#ifndef BASE_READFILE_H
#define BASE_READFILE_H
#include <stddef.h>
#include "status.h"

struct errinfo; /* errinfo.h */

/* readfile_all(path, most, bytes, len, e): the file ("-": standard input) of up to that many
 * bytes, with a zero byte behind it; *bytes is released by free(), also on failure.  A regular
 * file that is larger is not read at all.
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO, ST_ESIZE, ST_ENOMEM. */
enum status readfile_all(const char *path, size_t most, unsigned char **bytes,
                         size_t *len, struct errinfo *e);

#endif
