/* scan.h -- from the points of a scanner's file to one frontal face: the unit, the
 * face and its view, the crop, the gate. */
#ifndef CORE_SCAN_H
#define CORE_SCAN_H
#include <stdbool.h>
#include <stddef.h>
#include "face.h"
#include "find.h"
#include "surface_scan.h"
#include "shape.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */

/* Results of the search for the face, and of the points as they are, for a second call of
 * scan_build() with the same points and the other gate.  Between both calls the face that they have as
 * out must not be changed. */
struct scan_search {
    bool done;
    enum status st;          /* of the search */
    struct find_result find; /* set if st is ST_OK */
    struct shape_fit fit;    /* to the points in find's unit; set if st is ST_OK */
    double focal_times;      /* of surface_found */
    bool scaled;             /* true: other scales were tried */
    double fits_mm;          /* of surface_found */

    bool as_is;                 /* true: a model was made of the points as they are */
    enum status st_as_is;       /* of that model */
    size_t bad;                 /* as in face_build() */
    struct surface_face model;  /* its memory is out's */
    bool fitted;                /* true: the points as they are were fitted */
    enum status st_fitted;      /* of that fit */
    struct shape_fit fit_as_is; /* set if st_fitted is ST_OK */
};

/* A scan of more than FULL points is thinned to ENOUGH points of the face: what is measured by 4 mm
 * cells hardly changes with density (docs/accuracy.md). */
#define SCAN_FULL   10000
#define SCAN_ENOUGH 7000

enum scan_axes {
    SCAN_AXES_AUTO,   /* the face is found, whatever its pose */
    SCAN_AXES_SCANNER /* x to the image's right, y up, z towards the scanner: nothing is
                         rotated or cropped */
};

/* The place of the face in another frame of the same capture session. */
struct scan_near {
    double unit_mm;
    struct pose pose; /* points times unit_mm -> canonical frame */
};

struct scan_options {
    enum scan_axes axes;
    bool
        enrolment; /* the strict gate, and exactly one face, not mirrored, from the front */
    bool frame; /* with enrolment: without the strict gate, which is for the fused face */
    /* place to look for a face before a search; NULL: unknown */
    const struct scan_near *near;
    double step_mm; /* least distance between neighbouring depths of the points' frames */
    struct scan_search
        *search; /* results for a second call with the same points; NULL: not kept */
    const struct surface_stop *stop; /* NULL: none */
};

/* scan_build(c, o, w, out, bad, found): Builds a face from a scan.
 *   c      as cloudfile_read() returns; c->unit_mm 0: to be found.  Receives the points of the
 *          face, in the frontal view and mm, with their numbers among those read in index.
 *          Unspecified on failure, but still to be freed
 *   out    as in face_build()
 *   bad    as in face_build(), of the points given; may be NULL
 *   found  the caller sets points and kept
 * With SCAN_AXES_SCANNER the points stay as they are, except for their unit, and are thinned if there
 * are more than SCAN_FULL.  With SCAN_AXES_AUTO only the points of the face become a template:
 * db/FORMAT.md, "What is kept of the raw scan", has why that is enough.  A scan that already is
 * a frontal face is treated alike, so that two scans of a person are not cut by two rules.
 * The choice of points depends on their order by rounding only.
 * Cost: 16 bytes a point, and the cost of find_face(), freed at the end.
 * Returns ST_OK; as face_build(); ST_ENOFACE: none was found; ST_EUNITS also if a face is found in an
 * unusual unit (found->fits_mm); ST_ESEVERAL, ST_EMIRRORED: enrolment only; ST_EBUSY: by o->stop. */
enum status scan_build(struct cloudpoints *c, const struct scan_options *o,
                       struct surface_work *w, struct surface_face *out, size_t *bad,
                       struct surface_found *found);

#endif
