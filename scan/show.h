/* show.h -- faces as surfaces for a viewer: binary glTF (glbwrite.h), in the canonical
 * frame of the face that is looked at, mm.  Triangles that only bridge missing points are
 * left out. */
#ifndef SCAN_SHOW_H
#define SCAN_SHOW_H
#include <stddef.h>
#include "libsurface.h"
#include "status.h"

struct dvec3; /* vec.h */
struct json;  /* json.h */

/* What is shown: a file as glbwrite() makes it. */
struct show {
    unsigned char *glb; /* heap, for free(); NULL: none */
    size_t len;
};

/* show_calibration(j, c): what a viewer draws the curve of other people's scores from: the members
 * "threshold" and "knots".  show_knots(j, name, c): their share at or above each of some scores. */
void show_knots(struct json *j, const char *name, const struct surface_calibration *c);
void show_calibration(struct json *j, const struct surface_calibration *c);

/* show_between(cell, x, y): Returns the value at a place of the canonical frame, mm: linear between the
 * middles of the four cells around it, of those that have a value; NAN if its own cell has none. */
float show_between(const float cell[SURFACE_CELLS], double x, double y);

/* show_comparison(tmpl, probe, transform, parts, j, out): the node "template", and over it, moved
 * by transform, the node "probe", which has for each of its points
 *     _GAP_MM   how far it lies above the template along its scanner's z (surface_gaps()),
 *     _REST_MM  the gap without the motion and the change that explain most of it,
 *     _PART     what its cell adds to the score,
 * the last two of parts, between the centres of the cells; and COLOR_0, of _PART, whose opacity
 * is 0 where one of them is unknown (0).
 * j: as of glbwrite().  Returns ST_OK, ST_ENOMEM. */
enum status show_comparison(const struct surface_face *tmpl,
                            const struct surface_face *probe, const double transform[16],
                            const struct surface_parts *parts, struct json *j,
                            struct show *out);

/* show_scan(face, at, n, most, view, j, out): the node "face" (NULL: none was found), and with n > 0 the node "scan": points in
 * the scan's own unit and axes, moved by view (surface_found; without a face left as they are); of more than most an even choice.
 * Returns ST_OK, ST_ENOMEM. */
enum status show_scan(const struct surface_face *face, const struct dvec3 *at, size_t n,
                      size_t most, const double view[16], struct json *j,
                      struct show *out);

#endif
