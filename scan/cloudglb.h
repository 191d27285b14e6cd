/* cloudglb.h -- the GLB reader behind cloudfile.h: glTF 2.0 in one binary file. */
#ifndef SCAN_CLOUDGLB_H
#define SCAN_CLOUDGLB_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

#define CLOUDGLB_VALUES 100000 /* of JSON; 80 bytes each */

/* cloudglb_is(t): does a GLB file begin here? */
bool cloudglb_is(const struct cloudtext *t);

/* cloudglb_parse(t, list): t stands at the first byte of the file.  The vertices of the
 * scene's meshes, moved by the transforms of their nodes; skins, morph targets and cameras
 * are not looked at.  As cloudfile_read(). */
enum status cloudglb_parse(struct cloudtext *t, struct cloudlist *list);

#endif
