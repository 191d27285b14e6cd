/* find.h -- the face in a scanner's points, whatever their unit, axes and orientation, and
 * whatever else they show: the rest of the head, shoulders, a wall, other people.
 * (1) The unit: those by which the points are as large as a head; where no face is plain, as
 *     large as a room.
 * (2) Starting poses: seen from some side, places that stand out as a nose does, with every roll,
 *     by how well the mean face lies there (find_view.h).  The sides are those from which
 *     scanners look along agreed axes; where nothing is plain, all others, and all of them once
 *     more as if a child's head were larger.
 * (3) The shape of a face is fitted from the best of them, roughly, and from the best of these
 *     more closely (shape_seek()); what stands upright also by all modes, whose evidence (gate.h) may
 *     end the search.
 * All sums are in a fixed order, + - * / and sqrt only: the same digits everywhere. */
#ifndef CORE_FIND_H
#define CORE_FIND_H
#include <stddef.h>
#include <stdint.h>
#include "surface_scan.h"
#include "pose.h"
#include "status.h"
#include "vec.h"

/* A face looks at a scanner within 75 degrees (the cosine) of its axis, whichever way up the scanner
 * stands. */
#define FIND_FACING 0.2588

/* The worth of a fit (shape.h), and of eyes that are as the mean face's: what is plainly a face, as
 * neither the smooth back of a head is nor one the wrong way up; what is one if it is within 45
 * degrees (1 + 2 cos) of upright before a scanner; and what may well be one, so that other units
 * are not tried. */
#define FIND_WORTH_EYES    200.0
#define FIND_PLAIN         620.0
#define FIND_UPRIGHT       560.0
#define FIND_UPRIGHT_TRACE 2.4142
#define FIND_LIKELY        350.0

struct surface_work; /* face.h */

/* Units, the usual ones first: they are tried in this order. */
#define FIND_UNITS_MM                                                                    \
    {                                                                                    \
        1, 1000, 10, 25.4, 0.001                                                         \
    }

#define FIND_POSES 4

struct find_pose {
    double unit_mm;   /* millimetres per unit of the points */
    struct pose pose; /* points times unit_mm -> canonical frame */
    double
        worth; /* of the quick fit (shape.h), and of its eyes: FIND_PLAIN and more are a face;
                     the best of things that are not faces has less, as may a face that is covered or half
                     seen */
};

/* pose[0] is the best; pose[1] ... pose[n - 1] are others that may be right where it is not.
 * All are of one unit; n is 1 where the first is plainly right.  Poses less than about 10 mm and
 * 10 degrees apart count as one. */
struct find_result {
    struct find_pose pose[FIND_POSES];
    uint32_t n;
    uint32_t faces; /* in the cloud, at different places, each plainly a face; at least 1.
                       The poses are of the one nearest to the scanner, where all are turned
                       to one with the agreed axes or a camera's (y down, z away); else of the
                       one that is fitted best */
};

/* find_face(pts, n, unit_mm, w, stop, out): find the face in n points.
 * pts      finite, in any unit and axes.  At least 300 on the face
 * unit_mm  millimetres per unit; 0: to be found among um, mm, cm, inch and m
 * w        for its model and its memory
 * stop     asked before each step; NULL: none
 * Each pose is right to a few degrees and millimetres: a start for shape_fit(), which says
 * whether it is a face at all.
 * Cost: linear in n: the search ends with what it has where that is spent; memory 40 MB at most
 * for 300,000 points, allocated here and freed.  Returns ST_OK; ST_ENOFACE: no pose at all;
 * ST_EBUSY: stop was set; ST_ENOMEM. */
enum status find_face(const struct dvec3 *pts, size_t n, double unit_mm,
                      struct surface_work *w, const struct surface_stop *stop,
                      struct find_result *out);

/* find_once(...): Like find_face(), in the unit given alone, at a fifteenth of the cost at most: finds what is
 * plainly a face. */
enum status find_once(const struct dvec3 *pts, size_t n, double unit_mm,
                      struct surface_work *w, const struct surface_stop *stop,
                      struct find_result *out);

/* find_extent(pts, n): Returns the longest side of the box round n points, in their unit, but for one point
 * in FIND_STRAY_IN at either end. */
double find_extent(const struct dvec3 *pts, size_t n);

#endif
