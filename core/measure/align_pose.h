/* align_pose.h -- rigid motions, and the principal axes that starting poses come from. */
#ifndef CORE_ALIGN_POSE_H
#define CORE_ALIGN_POSE_H
#include <stdbool.h>
#include <stdint.h>
#include "vec.h"

/* Turns are taken about a point this far behind the surface, mm: a face is roughly a ball of
 * that radius, so that turns and shifts disturb each other least.  Turns count as lengths at
 * this distance. */
#define POSE_LEVER_MM 80.0

struct surface; /* surface.h */
struct mesh;    /* mesh.h */

/* p -> r p + t, r a rotation (row-major), millimetres. */
struct align_pose {
    double r[9], t[3];
};

static inline struct dvec3 align_pose_apply(const struct align_pose *a, struct dvec3 p)
{
    return (struct dvec3){a->r[0] * p.x + a->r[1] * p.y + a->r[2] * p.z + a->t[0],
                          a->r[3] * p.x + a->r[4] * p.y + a->r[5] * p.z + a->t[1],
                          a->r[6] * p.x + a->r[7] * p.y + a->r[8] * p.z + a->t[2]};
}

/* align_pose_move(a, c, x): append a small motion to a: a rotation about c by the vector
 * x[0..2], then a shift by x[3..5].  x[0..2] are radians to first order: the rotation is that
 * of the normalised quaternion (1, x/2), which needs no sine.  The rotation matrix stays
 * orthonormal to rounding. */
void align_pose_move(struct align_pose *a, struct dvec3 c, const double x[6]);

/* align_pose_tilt(a, c, yaw, pitch): append rotations about c, round y and then round x,
 * given by the tangents of their half angles. */
void align_pose_tilt(struct align_pose *a, struct dvec3 c, double yaw, double pitch);

void align_pose_to_matrix(const struct align_pose *a, double m[16]);
void align_pose_from_matrix(const double m[16], struct align_pose *a);

/* align_pose_after(a, b): first b, then the inverse of a.  Where a and b each map a surface
 * to the same frame, that moves b's surface to a's. */
struct align_pose align_pose_after(const struct align_pose *a,
                                   const struct align_pose *b);

/* align_pose_scale(a, by): p -> by (r p + t), a similarity: where poses are applied or moved, one may
 * stand in their place.
 * align_pose_unscaled(a): the rigid motion of which a is a multiple. */
struct align_pose align_pose_scale(const struct align_pose *a, double by);
struct align_pose align_pose_unscaled(const struct align_pose *a);

/* align_pose_origin(a): what a moves to the origin. */
struct dvec3 align_pose_origin(const struct align_pose *a);

/* align_pose_rigid(a): is a a rigid motion that shifts by less than 10^5 mm?  To check what
 * comes from a file. */
bool align_pose_rigid(const struct align_pose *a);

/* A surface's own axes. */
struct align_axes {
    struct dvec3 centre; /* the mean of the points, mm */
    struct dvec3
        axis[3];       /* right-handed: about x, y and z; z is the least axis of inertia,
                             y the greatest, both turned towards the scanner's */
    struct dvec3 nose; /* the mean of the points that stick out most along axis[2] */
};

/* align_pose_centre(m): the mean of the points, mm.  O(nv). */
struct dvec3 align_pose_centre(const struct mesh *m);

/* align_pose_axes(s, f): O(nv). */
void align_pose_axes(const struct surface *s, struct align_axes *f);

#endif
