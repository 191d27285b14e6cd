/* inflate.h -- decompresses request bodies (RFC 9110 section 8.4) and scans' files: gzip
 * (RFC 1952, all members of the file) and zstd (RFC 8878, all frames).  They are untrusted:
 * their size is bounded while they are decompressed. */
#ifndef BASE_INFLATE_H
#define BASE_INFLATE_H
#include <stddef.h>
#include "status.h"

struct errinfo;

enum inflate_coding {
    INFLATE_NONE,
    INFLATE_GZIP,
    INFLATE_ZSTD,
    INFLATE_OTHER /* not one that is read here, or more than one */
};

#define INFLATE_ACCEPTED "gzip, zstd" /* for Accept-Encoding */

/* inflate_coding(value): of a Content-Encoding's value; NULL: INFLATE_NONE. */
enum inflate_coding inflate_coding(const char *value);

/* inflate_body(coding, in, len, limit, out, outlen, e): undo gzip or zstd.
 * out    heap, released by mem_free(); out[outlen] is 0; NULL on failure.
 * limit  bytes; the memory taken is never more than that, one byte and the decoder's own:
 *        a window of 32 KB for gzip, of at most 8 MB for zstd (RFC 9659).
 * Cost   linear in what was read and written; at most limit bytes are written.
 * Returns ST_OK; ST_EINVAL damaged, truncated, or something else behind it; ST_ESIZE more
 * than limit bytes; ST_ENOMEM. */
enum status inflate_body(enum inflate_coding coding, const unsigned char *in, size_t len,
                         size_t limit, unsigned char **out, size_t *outlen,
                         struct errinfo *e);

#endif
