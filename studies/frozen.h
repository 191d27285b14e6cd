/* frozen.h -- the disparity of a pair with its domain frozen at one pose, as a function of the
 * pose alone, and a sound lower bound of it over a box of poses.
 *
 * The functional.  At the pose P0, the one that measure_at() measured, the general triangulation
 * has triangles T that are common, of area A(T).  A motion D(x) turns about a fixed centre and
 * shifts: descent_pose().  With P0 followed by D(x), every corner of these triangles has a gap:
 *   a corner from the probe, q   gap = z(D q) - t(D q), t the template as a height (field.h);
 *   one from the template, q     gap = b(D' q) - z(D' q), b the probe's height at P0, D' the
 *                                inverse of D: measured along the probe's own z.
 * The gap is linear over each triangle, as in the measure, and
 *   F(x) = sum of A(T) mean |gap over T| / sum of A(T), over the T of P0.
 * F(0) is the measure's plain_mm.  What F does not know: the triangles of the general
 * triangulation at other poses, their areas there, whether they bridge or leave the hull (the
 * surfaces are continued, bridges included), and coordinates rounded to the lattice.
 *
 * The bound.  For any |l(p)| <= 1 on the domain, F >= mean of l gap = sum of w gap over the
 * corners (weak duality; l = the sign of the gap at some pose, which is exact there).  Over a
 * box of poses, d from its middle, a corner's position is Taylor's polynomial of second degree
 * in d, and a rest of at most
 *   a^3 / 6 |y| (and for the inverse + a^2 / 2 |shift|), a the sum of the three turns:
 * the rotation is a product of three, each of whose derivatives has norm 1.  So the corner
 * stays over a square, where field_enclose() has two parallel planes round the height, and the
 * gap lies between two polynomials in d.  Taken by the sign of w and added, F >= a polynomial
 * over the box for each l, and so for each mixture; its least is bounded by the sum of its
 * terms' leasts.  Numbers are doubles rounded to nearest; the planes are 4 10^-5 mm further
 * apart than they were found, which is more than all rounding. */
#ifndef STUDIES_FROZEN_H
#define STUDIES_FROZEN_H
#include <stddef.h>
#include "descent.h"

struct face;
struct measure_work;

struct frozen;

/* frozen_new(tmpl, m): of what measure_at() left in m. */
struct frozen *frozen_new(const struct face *tmpl, const struct measure_work *m);
void frozen_free(struct frozen *f); /* NULL is allowed */

struct dvec3 frozen_centre(const struct frozen *f); /* of rotation */

/* frozen_value(f, x): F(x), by search of each point's triangle. */
double frozen_value(struct frozen *f, const double x[DESCENT_DIM]);

struct frozen_box {
    double c[DESCENT_DIM], h[DESCENT_DIM]; /* middle, half of the side */
    double least;                          /* F >= this over the box */
    double low[DESCENT_DIM]; /* a pose of it where F is low: there signs were taken */
    int widest;              /* along which the box is best cut in two */
};

/* frozen_bound(f, box): its least, low and widest. */
void frozen_bound(struct frozen *f, struct frozen_box *box);

/* frozen_outside(f, box, x): at x, a pose of the box, how many corners' gaps lie outside the
 * two polynomials that frozen_bound() takes them between, or these below their own bound over
 * the box: none.  For tests: a sum of thousands of such gaps forgives much. */
size_t frozen_outside(struct frozen *f, const struct frozen_box *box,
                      const double x[DESCENT_DIM]);

#endif
