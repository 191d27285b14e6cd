/* multipart.h -- the files of a multipart/form-data body (RFC 7578), as browsers and
 * `curl -F file=@scan.ply` send them.
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
#define MULTIPART_FILES_MAX    20 /* of a template */
#define MULTIPART_FRAMES_MAX   10 /* of a probe */

/* multipart_boundary(type, out): the parameter boundary of a Content-Type's value.  False: it
 * has none that RFC 2046 allows, and out is "". */
bool multipart_boundary(const char *type, char out[MULTIPART_BOUNDARY_MAX + 1]);

struct multipart_file {
    const unsigned char *data; /* in the body */
    size_t len;
    char field[MULTIPART_VALUE_MAX];  /* the part's name, of the form */
    char name[MULTIPART_VALUE_MAX];   /* the file's, of the sender's machine; "": none */
    char type[MULTIPART_VALUE_MAX];   /* Content-Type; "": none */
    char coding[MULTIPART_VALUE_MAX]; /* Content-Encoding; "": none */
};

/* multipart_read(body, len, boundary, most, out, n, e): the parts of the body, in their order:
 * one, or up to `most` (at most MULTIPART_FILES_MAX) that have a file name each, so that a
 * parameter among them is not taken for a file.  Nothing is before the first delimiter and nothing
 * but blanks and line ends after the last; each part has Content-Disposition: form-data with a
 * name.
 * Returns ST_OK, and their number in *n, which is 0 on failure; ST_EINVAL malformed, or other parts than these, which *e
 * names.  O(len). */
enum status multipart_read(const unsigned char *body, size_t len, const char *boundary,
                           size_t most, struct multipart_file *out, size_t *n,
                           struct errinfo *e);

#endif
