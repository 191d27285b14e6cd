/* cloudwrite.h -- a mesh as a scanner's file. */
#ifndef SCAN_CLOUDWRITE_H
#define SCAN_CLOUDWRITE_H
#include <stdio.h>

struct mesh; /* mesh.h */

/* cloudwrite_ply(to, m): m as PLY in millimetres, to the last digit of the lattice.  Errors are
 * those of the stream. */
void cloudwrite_ply(FILE *to, const struct mesh *m);

#endif
