/* scan.h -- from the points of a scanner's file to the model of one frontal face: the unit, the
 * face and its view, the crop, the gate. */
#ifndef CORE_SCAN_H
#define CORE_SCAN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "find.h"
#include "surface_scan.h"
#include "shape.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */

/* What the search for the face found, and what the points are as they are, so that
 * a second call of scan_build() for the same points, by the other gate, need not compute it again.
 * Between the two calls nobody changes the face that they have as out. */

struct scan_search {
    bool done;
    enum status st;          /* of the search */
    struct find_result find; /* where st is ST_OK, as is the fit */
    struct shape_fit fit;    /* to the points in find's unit */
    double focal_times;      /* of surface_found */
    bool scaled;             /* other scales were tried */
    double fits_mm;          /* of surface_found */

    bool as_is;                 /* a model was made of the points as they are */
    enum status st_as_is;       /* of that */
    size_t bad;                 /* as of face_build() */
    struct surface_face model;  /* its memory is out's */
    bool fitted;                /* they were fitted, too */
    enum status st_fitted;      /* of that */
    struct shape_fit fit_as_is; /* where st_fitted is ST_OK */
};

/* Scans of FULL points are not thinned; those of more, to ENOUGH points of the face, if it
 * has more: what is measured by 4 mm cells hardly changes with density (docs/accuracy.md). */
#define SCAN_FULL   10000
#define SCAN_ENOUGH 7000

enum scan_axes {
    SCAN_AXES_AUTO,   /* the face is found, whatever its pose */
    SCAN_AXES_SCANNER /* x to the image's right, y up, z towards the scanner: nothing is
                         turned or cropped */
};

/* Where the face lay in another frame of the same capture session. */
struct scan_near {
    double unit_mm;
    struct pose pose; /* points times unit_mm -> canonical frame */
};

struct scan_options {
    enum scan_axes axes;
    bool
        enrolment; /* the strict gate, and exactly one face, not mirrored, from the front */
    bool frame; /* with enrolment: all but the strict gate, which is for the fused face */
    /* a face is looked for near it, and searched for only if there is none; NULL: not known */
    const struct scan_near *near;
    double
        step_mm; /* between neighbouring depths at least, of frames that the points are of */
    struct scan_search *search; /* kept from the first call to the second for the same
                                   points; NULL: not kept */
    const struct surface_stop *stop; /* NULL: none */
};

/* scan_build(c, o, w, out, found): the model of the face in c.
 * c      as cloudfile_read() left it, c->unit_mm 0: to be found.  Afterwards the points of the
 *        face alone, in the frontal view and mm; index as before has their places among those
 *        read.  On failure unspecified, but still to be freed
 * out    as in face_build()
 * bad    as in face_build(), of the points before; may be NULL
 * With SCAN_AXES_SCANNER the points stay as they are, but for their unit, and are thinned where there
 * are more than SCAN_FULL.  With SCAN_AXES_AUTO the points of the face become a template, and nothing
 * else of the scan is kept: db/FORMAT.md, "What is kept of the raw scan", has why that is enough.  That
 * a scan is a frontal face already makes no difference, so that two scans of a person are not cut by
 * two rules.
 * Which points these are depends on their order by rounding only.  Memory: 16 bytes a point,
 * and what find_face() takes, freed at the end.
 * found->points and ->kept are left to the caller.
 * Returns ST_OK; as face_build(); ST_ENOFACE: none was found; ST_EUNITS also if one is found in an
 * unusual unit (found->fits_mm); ST_ESEVERAL, ST_EMIRRORED: enrolment alone; ST_EBUSY: by o->stop. */
enum status scan_build(struct cloudpoints *c, const struct scan_options *o,
                       struct surface_work *w, struct surface_face *out, size_t *bad,
                       struct surface_found *found);

#endif
