/* multipart.h -- the one file of a multipart/form-data body (RFC 7578), as browsers and
 * `curl -F file=@scan.ply` send it.
 * Not libmicrohttpd's MHD_PostProcessor: it wants the connection and a copy through its
 * callback, where the body is in memory already, and lets much pass that is malformed. */
#ifndef SERVER_MULTIPART_H
#define SERVER_MULTIPART_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct errinfo; /* errinfo.h */

#define MULTIPART_BOUNDARY_MAX 70 /* RFC 2046 section 5.1.1 */
#define MULTIPART_VALUE_MAX    128
#define MULTIPART_PARTS_MAX    8 /* that are read, to name them */

/* multipart_boundary(type, out): the parameter boundary of a Content-Type's value.  False: it
 * has none that RFC 2046 allows, and out is "". */
bool multipart_boundary(const char *type, char out[MULTIPART_BOUNDARY_MAX + 1]);

struct multipart_file {
    const unsigned char *data; /* in the body */
    size_t len;
    char type[MULTIPART_VALUE_MAX];   /* Content-Type; "": none */
    char coding[MULTIPART_VALUE_MAX]; /* Content-Encoding; "": none */
};

/* multipart_file(body, len, boundary, out, e): the only part of the body.  Nothing is before
 * the first delimiter and nothing but blanks and line ends after the last; each part has
 * Content-Disposition: form-data with a name.
 * Returns ST_OK; ST_EINVAL malformed, or other than one part, which *e names.  O(len). */
enum status multipart_file(const unsigned char *body, size_t len, const char *boundary,
                           struct multipart_file *out, struct errinfo *e);

#endif
