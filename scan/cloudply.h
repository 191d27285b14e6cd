/* cloudply.h -- the PLY reader behind cloudfile.h, and a writer. */
#ifndef SCAN_CLOUDPLY_H
#define SCAN_CLOUDPLY_H
#include <stdbool.h>
#include <stdio.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */
struct mesh;      /* mesh.h */

/* cloudply_is(t): does a PLY file begin here? */
bool cloudply_is(const struct cloudtext *t);

/* cloudply_parse(t, list): t stands at the first byte of the file.  As cloudfile_read();
 * ST_EVERSION also for a header that is too large (cloudplyhead.h). */
enum status cloudply_parse(struct cloudtext *t, struct cloudlist *list);

/* cloudply_write(to, m): a mesh as PLY in millimetres, to the last digit of the lattice. */
void cloudply_write(FILE *to, const struct mesh *m);

#endif
