/* inflate.h -- decompresses request bodies (RFC 9110 section 8.4) and scans' files: gzip (RFC 1952, all
 * members) and zstd (RFC 8878, all frames).  They are untrusted: the decompressed size is limited. */
#ifndef BASE_INFLATE_H
#define BASE_INFLATE_H
#include <stddef.h>
#include "status.h"

struct errinfo;

enum inflate_coding {
    INFLATE_NONE,
    INFLATE_GZIP,
    INFLATE_ZSTD,
    INFLATE_OTHER /* another coding, or several codings */
};

#define INFLATE_ACCEPTED "gzip, zstd" /* for Accept-Encoding */

/* inflate_coding(value): Returns the coding that the value of Content-Encoding names; NULL: INFLATE_NONE. */
enum inflate_coding inflate_coding(const char *value);

/* inflate_body(coding, in, len, limit, out, outlen, e): Decompresses gzip or zstd.
 *   limit   greatest size of the output, bytes
 *   out     to be released by mem_free(); out[outlen] is 0; on failure: NULL
 * Cost: O(input + output).  Memory: limit + 1 bytes, and the decoder's: a window of 32 KB for gzip, of up to
 * 8 MB for zstd (RFC 9659).
 * Returns ST_OK; ST_EINVAL: damaged, truncated, or followed by other bytes; ST_ESIZE: more than limit bytes;
 * ST_ENOMEM. */
enum status inflate_body(enum inflate_coding coding, const unsigned char *in, size_t len,
                         size_t limit, unsigned char **out, size_t *outlen,
                         struct errinfo *e);

#endif
