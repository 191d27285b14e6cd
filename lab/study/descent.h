/* descent.h -- minima of a function of six numbers by its values alone, no derivatives: what
 * the studies check production's minimum with.  It shares nothing with core. */
#ifndef STUDY_DESCENT_H
#define STUDY_DESCENT_H
#include "vec.h"

#define DESCENT_DIM   6
#define DESCENT_LEVER 80.0 /* mm a radian: turns are counted as a length */

/* The function; INFINITY where x is not allowed.  Values are counted in calls. */
struct descent {
    double (*value)(void *arg, const double x[DESCENT_DIM]);
    void *arg;
    unsigned calls;
};

/* descent_pose(base, c, x, out): the pose base, then rotations about c round the axes x, y
 * and z by x[0], x[1] and x[2] over DESCENT_LEVER (radians), then a shift by x[3..5] (mm). */
void descent_pose(const double base[16], struct dvec3 c, const double x[DESCENT_DIM],
                  double out[16]);

/* descent_between(base, c, pose, x): the x with which descent_pose(base, c, x) is pose; all
 * turns below 90 degrees. */
void descent_between(const double base[16], struct dvec3 c, const double pose[16],
                     double x[DESCENT_DIM]);

/* descent_angle(x): the angle of the one rotation that the three turns make, degrees. */
double descent_angle(const double x[DESCENT_DIM]);

/* descent_pattern(d, x, from, to): pattern search (Hooke and Jeeves): steps of `from` along
 * each axis and along the last progress, halved where none helps, down to `to`.  x moves to the
 * least value found, which is returned. */
double descent_pattern(struct descent *d, double x[DESCENT_DIM], double from, double to);

/* descent_simplex(d, x, step, least, most): Nelder and Mead from a simplex with edges of
 * `step` until it is smaller than `least`, at most `most` values.  x and result likewise. */
double descent_simplex(struct descent *d, double x[DESCENT_DIM], double step,
                       double least, unsigned most);

#endif
