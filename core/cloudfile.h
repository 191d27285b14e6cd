/* cloudfile.h -- scanner files in memory: PLY, OBJ and XYZ, vertex positions only.
 * Every byte is hostile.  Nothing is opened, nothing is fetched. */
#ifndef CORE_CLOUDFILE_H
#define CORE_CLOUDFILE_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

enum cloudfile_format {
    CLOUDFILE_ANY, /* recognised by its first bytes */
    CLOUDFILE_PLY, /* ascii, binary_little_endian, binary_big_endian, version 1.0 */
    CLOUDFILE_OBJ, /* "v x y z" lines */
    CLOUDFILE_XYZ  /* three numbers a line (more are ignored), # comments */
};

struct cloudfile_error {
    size_t where;   /* byte offset */
    uint32_t line;  /* line number from 1 for text, 0 in binary data */
    char what[96];  /* "the header promises 3000 vertices, the data ends in the 1200th" */
};

/* cloudfile_parse(bytes, len, format, max_points, out, n, err)
 * out   new array of *n points in the file's own units, released by mem_free(); NULL on
 *       error
 * err   filled on every failure but ST_ENOMEM; may be NULL
 * Numbers are read alike in every locale.  Cost O(len) time, O(points) memory: a lying
 * header cannot make it allocate more than the bytes present could hold.
 * Returns ST_OK; ST_EINVAL malformed or truncated; ST_ENOTFINITE; ST_ELIMIT more than
 * max_points; ST_EVERSION a format variant not supported; ST_ENOMEM. */
enum status cloudfile_parse(const void *bytes, size_t len, enum cloudfile_format format,
                            size_t max_points, struct dvec3 **out, size_t *n,
                            struct cloudfile_error *err);

#endif
