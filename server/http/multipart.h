/* multipart.h -- the files of a multipart/form-data body (RFC 7578), as browsers and
 * `curl -F file=@scan.ply` send them.
 * libmicrohttpd's MHD_PostProcessor needs the connection, copies the body, which is in memory already, through its
 * callback, and accepts many malformed bodies. */
#ifndef SERVER_MULTIPART_H
#define SERVER_MULTIPART_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo; /* errinfo.h */

#define MULTIPART_BOUNDARY_MAX 70 /* RFC 2046 section 5.1.1 */
#define MULTIPART_VALUE_MAX    128
#define MULTIPART_FILES_MAX    20 /* files of a template */
#define MULTIPART_FRAMES_MAX   10 /* files of a probe */

/* multipart_boundary(type, out): Copies the parameter boundary of a Content-Type.  Returns false, and sets out to "",
 * if there is none that RFC 2046 allows. */
bool multipart_boundary(const char *type, char out[MULTIPART_BOUNDARY_MAX + 1]);

struct multipart_file {
    const unsigned char *data; /* borrowed from the body */
    size_t len;
    char field[MULTIPART_VALUE_MAX]; /* name of the part */
    char name
        [MULTIPART_VALUE_MAX]; /* name of the file on the client's machine; "": none */
    char type[MULTIPART_VALUE_MAX];   /* Content-Type; "": none */
    char coding[MULTIPART_VALUE_MAX]; /* Content-Encoding; "": none */
};

/* multipart_read(body, len, boundary, most, out, n, e): Reads the parts of the body in their order.  There must be one
 * part, or up to `most` parts with a file name each, so that a parameter is not taken for a file.  Each has
 * Content-Disposition: form-data with a name.  Text before the first delimiter is ignored; after the last one
 * only blanks and line ends are allowed.  Cost: O(len).
 *   most  at most MULTIPART_FILES_MAX
 *   n     set to the number of parts; 0 on failure
 * ST_OK; ST_EINVAL: malformed, or other parts, which *e names. */
enum status multipart_read(const unsigned char *body, size_t len, const char *boundary,
                           size_t most, struct multipart_file *out, size_t *n,
                           struct errinfo *e);

#endif
