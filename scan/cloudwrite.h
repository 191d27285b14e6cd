/* cloudwrite.h -- a face as a scanner's file. */
#ifndef SCAN_CLOUDWRITE_H
#define SCAN_CLOUDWRITE_H
#include <stdio.h>
#include "status.h"

struct surface_face; /* libsurface.h */

/* cloudwrite_ply(to, f): f's points and triangles as PLY in millimetres, to the last digit of the
 * lattice.  Errors are those of the stream, but ST_ENOMEM. */
enum status cloudwrite_ply(FILE *to, const struct surface_face *f);

#endif
