/* cloudfile.h -- the points of a scanner's file in memory: PLY, OBJ or XYZ.
 * Any bytes are safe.  Nothing that a file names is opened or fetched. */
#ifndef SCAN_CLOUDFILE_H
#define SCAN_CLOUDFILE_H
#include <stddef.h>
#include "clouderror.h"
#include "status.h"
#include "vec.h"

enum cloudfile_format {
    CLOUDFILE_ANY, /* recognised by its first bytes */
    CLOUDFILE_PLY, /* ascii, binary_little_endian, binary_big_endian, version 1.0 */
    CLOUDFILE_OBJ, /* "v x y z" lines */
    CLOUDFILE_XYZ  /* three numbers a line (more are ignored), # comments */
};

/* cloudfile_parse(bytes, len, format, max_points, out, n, err)
 * out   new array of *n points in the file's own units, released by mem_free(); NULL on
 *       error
 * err   filled on every failure but ST_ENOMEM; may be NULL
 * PLY   every scalar type, lists, any other elements and properties; each row of an ascii
 *       file on a line of its own.  The data must be what the header says: too few rows,
 *       values on a line too many, or bytes after the last row are errors (elements that
 *       follow the vertices are not read).  No vertices at all is ST_OK with *n == 0.
 * OBJ   "v" with 3 to 8 numbers, the first three taken; a backslash continues a line;
 *       other keywords are skipped.
 * XYZ   numbers separated by blanks, by commas or by semicolons, but not by a mixture (which
 *       would be a decimal comma); lines that begin with # or // are comments, and the first
 *       other line may be a heading, which begins with a letter or a quotation mark.
 * Numbers do not depend on the locale and are correctly rounded.  Cost O(len) time; memory
 * at most 8 bytes per byte of input, whatever the header claims.
 * Returns ST_OK; ST_EINVAL malformed or truncated; ST_ENOTFINITE; ST_ELIMIT more than
 * max_points; ST_EVERSION a format variant not supported; ST_ENOMEM. */
enum status cloudfile_parse(const void *bytes, size_t len, enum cloudfile_format format,
                            size_t max_points, struct dvec3 **out, size_t *n,
                            struct clouderror *err);

#endif
