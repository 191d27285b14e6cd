/* pose.h -- rigid motions, and the principal axes that starting poses come from. */
#ifndef CORE_POSE_H
#define CORE_POSE_H
#include <stdbool.h>
#include "vec.h"

/* mm behind the surface: the centre of rotations.  A face is roughly a ball of
 * that radius, so that rotations and shifts disturb each other least.  Rotations count as arcs at
 * this distance. */
#define POSE_LEVER_MM 80.0

struct surface; /* surface.h */
struct mesh;    /* mesh.h */

/* p -> r p + t, r a rotation (row-major), millimetres. */
struct pose {
    double r[9], t[3];
};

static inline struct dvec3 pose_apply(const struct pose *a, struct dvec3 p)
{
    return (struct dvec3){a->r[0] * p.x + a->r[1] * p.y + a->r[2] * p.z + a->t[0],
                          a->r[3] * p.x + a->r[4] * p.y + a->r[5] * p.z + a->t[1],
                          a->r[6] * p.x + a->r[7] * p.y + a->r[8] * p.z + a->t[2]};
}

/* pose_move(a, c, x): Appends a small motion to a: a rotation about c by the vector
 * x[0..2], then a shift by x[3..5].  x[0..2] are radians to first order: the rotation is that
 * of the normalised quaternion (1, x/2), which needs no sine.  The rotation matrix stays
 * orthonormal to rounding. */
void pose_move(struct pose *a, struct dvec3 c, const double x[6]);

/* pose_tilt(a, c, yaw, pitch): Appends rotations about c, round y and then round x,
 * given by the tangents of their half angles. */
void pose_tilt(struct pose *a, struct dvec3 c, double yaw, double pitch);

void pose_to_matrix(const struct pose *a, double m[16]);
void pose_from_matrix(const double m[16], struct pose *a);

/* pose_after(a, b): Returns first b, then the inverse of a.  If a and b each map a surface
 * to the same frame, the result moves b's surface to a's. */
struct pose pose_after(const struct pose *a, const struct pose *b);

/* pose_follow(a, b): Returns first b, then a. */
struct pose pose_follow(const struct pose *a, const struct pose *b);

/* pose_scale(a, by): Returns the similarity p -> by (r p + t).  It may be applied and moved like a
 * pose. */
struct pose pose_scale(const struct pose *a, double by);

/* pose_unscaled(a): Returns the rigid motion of which a is a multiple. */
struct pose pose_unscaled(const struct pose *a);

/* pose_origin(a): Returns the point that a moves to the origin. */
struct dvec3 pose_origin(const struct pose *a);

/* pose_rigid(a): Returns true if a is a rigid motion that shifts by less than 10^5 mm: for poses
 * from a file. */
bool pose_rigid(const struct pose *a);

/* A surface's own axes. */
struct pose_axes {
    struct dvec3 centre; /* the mean of the points, mm */
    struct dvec3
        axis[3];       /* right-handed: about x, y and z; z is the least axis of inertia,
                             y the greatest, both turned towards the scanner's */
    struct dvec3 nose; /* the mean of the points that stick out most along axis[2] */
};

/* pose_centre(m): Returns the mean of the points, mm.  Cost: O(nv). */
struct dvec3 pose_centre(const struct mesh *m);

/* pose_find_axes(s, f): Computes the axes of s.  Cost: O(nv). */
void pose_find_axes(const struct surface *s, struct pose_axes *f);

#endif
