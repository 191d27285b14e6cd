/* cloudply.h -- the PLY reader behind cloudfile.h. */
#ifndef SCAN_CLOUDPLY_H
#define SCAN_CLOUDPLY_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct cloudtext; /* cloudtext.h */
struct dvec3;     /* vec.h */

#define CLOUDPLY_ELEMENTS   16
#define CLOUDPLY_PROPERTIES 256

/* cloudply_is(t): does a PLY file begin here? */
bool cloudply_is(const struct cloudtext *t);

/* cloudply_parse(t, max_points, out, n): t stands at the first byte of the file.  As
 * cloudfile_parse(); ST_EVERSION also for a header with more than CLOUDPLY_ELEMENTS
 * elements or CLOUDPLY_PROPERTIES properties. */
enum status cloudply_parse(struct cloudtext *t, size_t max_points, struct dvec3 **out,
                           size_t *n);

#endif
