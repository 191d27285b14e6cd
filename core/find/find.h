/* find.h -- the face in a scanner's points, whatever their unit, axes and orientation, and
 * whatever else they show: the rest of the head, shoulders, a wall, other people.
 * (1) Units: those that make the points as large as a head; without a definite face those that make
 *     them as large as a room.
 * (2) Starting poses: places that protrude as a nose does, seen from some side, with every roll,
 *     ranked by how well the mean face lies there (find_view.h).  First the sides from which
 *     scanners look along agreed axes; without a definite face all other sides, and all sides once
 *     more as if a child's head were larger.
 * (3) The shape of a face is fitted roughly from the best starts, and more closely from the best of
 *     these fits (shape_seek()).
 * All sums are in a fixed order, + - * / and sqrt only: the same digits everywhere. */
#ifndef CORE_FIND_H
#define CORE_FIND_H
#include <stddef.h>
#include <stdint.h>
#include "pose.h"
#include "status.h"
#include "surface_scan.h"
#include "vec.h"

/* A face looks at a scanner within 75 degrees (the cosine) of its axis, in whatever roll the scanner
 * is. */
#define FIND_FACING 0.2588

/* The fit score from which on a pose is definitely a face.  Neither the smooth back of a head nor a face
 * upside down has it; nor may a face that is covered or half seen. */
#define FIND_PLAIN 620.0

struct surface_work; /* face_work.h */

/* Units, in the order in which they are tried. */
#define FIND_UNITS_MM                                                                    \
    {                                                                                    \
        1, 1000, 10, 25.4, 0.001                                                         \
    }

#define FIND_POSES 4

struct find_pose {
    double unit_mm;   /* millimetres per unit of the points */
    struct pose pose; /* points times unit_mm -> canonical frame */
    double worth;     /* fit score, of the quick fit (shape.h) and its eyes */
};

struct find_result {
    /* pose[0] is the best; the others may be right if it is not.  All have one unit.  Poses less than
     * about 10 mm and 10 degrees apart count as one */
    struct find_pose pose[FIND_POSES];
    uint32_t n; /* number of poses; 1 if the first is definitely right */
    uint32_t
        faces; /* number of definite faces at different places, at least 1.  The poses are
                       those of the face nearest to the scanner if all look at a scanner with the
                       agreed axes or a camera's (y down, z away), else of the best fit */
};

/* find_face(pts, n, unit_mm, w, stop, out): Finds the face in n points.
 *   pts      finite, in any unit and axes; at least 300 on the face
 *   unit_mm  millimetres per unit; 0: to be found among FIND_UNITS_MM
 *   w        for its model and its memory
 *   stop     asked before each step; NULL: none
 *   out      each pose is right to a few degrees and millimetres: a start for shape_fit(), which tells
 *            whether it is a face at all
 * Cost: O(n), as the search has a budget; up to 40 MB for 300,000 points, freed at the end.
 * Returns ST_OK; ST_ENOFACE: no pose at all; ST_EBUSY: by stop; ST_ENOMEM. */
enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      struct surface_work *w, const struct surface_stop *stop,
                      struct find_result *out);

/* find_once(pts, n, w, stop, out): Like find_face(), for points in mm, but finds definite faces only.
 * Cost: at most a fifteenth of find_face(). */
enum status find_once(const struct dvec3 *pts, size_t n, struct surface_work *w,
                      const struct surface_stop *stop, struct find_result *out);

/* find_extent(pts, n): Returns the longest side of the box around n points, in their unit, without
 * one point in FIND_STRAY_IN at either end. */
double find_extent(const struct dvec3 *pts, size_t n);

#endif
