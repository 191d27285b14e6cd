/* readfile.h -- all of a file at once. */
#ifndef BASE_READFILE_H
#define BASE_READFILE_H
#include <stddef.h>
#include "status.h"

struct errinfo; /* errinfo.h */

/* readfile_all(path, most, bytes, len, e): Reads a file ("-": standard input), and appends a zero byte.
 *   most    greatest number of bytes; a larger regular file is not read at all
 *   bytes   to be released by free(), also on failure
 * Returns ST_OK; ST_ENOTFOUND; ST_EIO; ST_ESIZE: more than most bytes; ST_ENOMEM. */
enum status readfile_all(const char *path, size_t most, unsigned char **bytes,
                         size_t *len, struct errinfo *e);

#endif
