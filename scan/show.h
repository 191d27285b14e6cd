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

/* A file as glbwrite() makes it. */
struct show {
    unsigned char *glb; /* heap, for free(); NULL: none */
    size_t len;
};

/* show_knots(j, name, c): Writes an array of scores, each with the share of non-mated comparisons at or above
 * it. */
void show_knots(struct json *j, const char *name, const struct surface_calibration *c);

/* show_calibration(j, c): Writes the members "threshold" and "knots", from which a viewer draws the curve of
 * other people's scores. */
void show_calibration(struct json *j, const struct surface_calibration *c);

/* show_between(cell, x, y): Returns the value at a place of the canonical frame, mm: linear between the
 * middles of the four cells around it that have a value; NAN if its own cell has none. */
float show_between(const float cell[SURFACE_CELLS], double x, double y);

/* show_comparison(tmpl, probe, transform, parts, j, out): Writes the node "template" and over it, moved by
 * transform, the node "probe" with these numbers for each of its points:
 *     _GAP_MM   height above the template along its scanner's z (surface_gaps())
 *     _REST_MM  the gap without the motion and the change that explain most of it
 *     _PART     the part that its cell adds to the score
 * and COLOR_0, the colour of _PART.  _REST_MM and _PART are taken from parts, between the middles of the cells.
 * If one of the numbers is unknown, all three are 0 and so is the opacity.
 *   j  as in glbwrite()
 * Returns ST_OK; ST_ENOMEM. */
enum status show_comparison(const struct surface_face *tmpl,
                            const struct surface_face *probe, const double transform[16],
                            const struct surface_parts *parts, struct json *j,
                            struct show *out);

/* show_scan(face, at, n, most, view, j, out): Writes the node "face" and, if n > 0, the node "scan", of the
 * points at, or an even choice if they are more than `most`.
 *   face  NULL: none was found
 *   at    in the scan's own unit and axes
 *   view  moves the points (surface_found); without a face they stay where they are
 * Returns ST_OK; ST_ENOMEM. */
enum status show_scan(const struct surface_face *face, const struct dvec3 *at, size_t n,
                      size_t most, const double view[16], struct json *j,
                      struct show *out);

/* show_asymmetry(j, a): Adds the members of a, as members of the object that is open in j. */
void show_asymmetry(struct json *j, const struct surface_asymmetry *a);

#endif
