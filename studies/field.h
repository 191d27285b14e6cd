/* field.h -- a triangulated surface as a height over the whole plane, with enclosures of it by
 * planes over squares: what a sound bound needs.  Millimetres.
 * The height is linear on each triangle, bridging ones included; beyond the hull it is that of
 * a ring of triangles to the hull's vertices moved four times as far from their middle, at
 * their own heights: continuous everywhere. */
#ifndef STUDIES_FIELD_H
#define STUDIES_FIELD_H
#include <stdbool.h>

struct field;
struct mesh; /* mesh.h */

struct field *field_new(const struct mesh *m); /* lattice units at LATTICE_PER_MM */
void field_free(struct field *f);              /* NULL is allowed */

/* field_at(f, x, y): the height; NAN beyond the ring. */
double field_at(const struct field *f, double x, double y);

/* lo + s <= height <= hi + s, with s = sx (X - x) + sy (Y - y), wherever (X, Y) lies in the
 * square. */
struct field_plane {
    double x, y, sx, sy, lo, hi;
};

/* field_enclose(f, x, y, r, out): planes for a square that contains the one round (x, y) with
 * sides 2 r: that square itself where r <= 0.8 mm, else one of less than 1.6 times its side.
 * False: too large, or too far from the surface. */
bool field_enclose(const struct field *f, double x, double y, double r,
                   struct field_plane *out);

#endif
