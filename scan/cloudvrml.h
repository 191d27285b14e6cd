/* cloudvrml.h -- the reader of VRML 1.0 and 2.0 (.wrl) behind cloudfile.h. */
#ifndef SCAN_CLOUDVRML_H
#define SCAN_CLOUDVRML_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

#define CLOUDVRML_DEPTH 64 /* of nodes and lists in each other */
#define CLOUDVRML_NAMES 64 /* of nodes with points */

/* cloudvrml_is(t): does a VRML file begin here? */
bool cloudvrml_is(const struct cloudtext *t);

/* cloudvrml_parse(t, list): the points of the nodes Coordinate (VRML 2.0) and Coordinate3
 * (1.0), moved by the Transforms above them (1.0: before them); normals by the faces of the
 * IndexedFaceSets, if those can be read.  Other nodes are passed over.  t stands at the first
 * byte of the file.  As cloudfile_read(); ST_EVERSION also for what might move, repeat or
 * choose points in another way (Inline, LOD, MatrixTransform, PROTO, Switch, USE of points in
 * another place), and for more than CLOUDVRML_DEPTH or CLOUDVRML_NAMES. */
enum status cloudvrml_parse(struct cloudtext *t, struct cloudlist *list);

#endif
