/* find.h -- the face in a scanner's points, whatever their unit, axes and orientation, and
 * whatever else they show: the rest of the head, shoulders, a wall, other people.
 * (1) The unit: those by which the points are as large as a head; where no face is plain, as
 *     large as a room.  Of a room the connected parts of a head's size are searched.
 * (2) Starting poses: places that stick out as a nose does (find_nose.h), with every roll about
 *     the direction in which they do so, by the cost of laying the mean face there
 *     (find_place.h); where nothing is plain, with tilted directions too.
 * (3) The best of them are refined and judged (find_refine.h).
 * All sums are in a fixed order, + - * / and sqrt only: the same digits everywhere. */
#ifndef SCAN_FIND_H
#define SCAN_FIND_H
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include "align_pose.h"
#include "status.h"
#include "vec.h"

struct face_work; /* face.h */

#define FIND_POSES 3

struct find_pose {
    double unit_mm;         /* millimetres per unit of the points */
    struct align_pose pose; /* points times unit_mm -> canonical frame */
    double key;      /* how well the mean face explains the points there, about 0.7 where
                        there is no face, 1.0 to 1.6 on a face, less on a covered one */
    double likeness; /* of the reliefs, as frame_likeness() */
    double covered;  /* share of the mean face's cells that points cover, 0..1 */
};

/* pose[0] is the best; pose[1] ... pose[n - 1] are others that may be right where it is not:
 * a covered face fits the mean face in more than one way.  All are of one unit; n is 1 where
 * the first is plainly right.  Poses less than about 10 mm and 10 degrees apart count as one. */
struct find {
    struct find_pose pose[FIND_POSES];
    uint32_t n;
    uint32_t faces; /* in the cloud, at different places, each plainly a face; at least 1.
                       The poses are of the one nearest to the scanner, where all are turned
                       to one with the agreed axes or a camera's (y down, z away); else of the
                       one with the most points on it */
};

/* find_face(pts, n, unit_mm, w, stop, out): find the face in n points.
 * pts      finite, in any unit and axes.  At least 300 on the face
 * unit_mm  millimetres per unit; 0: to be found among um, mm, cm, inch and m
 * w        for its model; not changed
 * stop     when another thread sets it, the search ends; NULL: none does
 * Each pose is near that of frame_find() (a few degrees and millimetres): a start for what
 * refines it.  Whether it is a face at all, the key does not tell: shape_fit() does.
 * Cost: linear in n, and beyond that bounded; memory 40 MB at most for 300,000 points,
 * allocated here and freed.  Returns ST_OK; ST_ENOFACE: no pose at all; ST_EBUSY: stop
 * was set; ST_ENOMEM. */
enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      const struct face_work *w, const atomic_bool *stop,
                      struct find *out);

#endif
