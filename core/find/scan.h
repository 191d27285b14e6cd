/* scan.h -- from the points of a scanner's file to the model of one frontal face: the unit, the
 * face and its view, the crop, the gate. */
#ifndef FIND_SCAN_H
#define FIND_SCAN_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "find.h"
#include "gate.h"
#include "shape.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct face;        /* face.h */
struct face_work;   /* face.h */

/* What the search for the face found, and what the points are as they are, so that
 * a second call of scan_build() for the same points, by the other gate, need not compute it again.
 * Between the two calls nobody changes the face that they have as out. */

struct scan_search {
    bool done;
    enum status st;       /* of the search */
    struct find find;     /* where st is ST_OK, as is the fit */
    struct shape_fit fit; /* to the points in find's unit */

    bool as_is;                 /* a model was made of the points as they are */
    enum status st_as_is;       /* of that */
    size_t bad;                 /* as of face_build() */
    struct face model;          /* its memory is out's */
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

struct scan_options {
    enum scan_axes axes;
    bool enrolment;             /* the strict gate */
    struct scan_search *search; /* kept from the first call to the second for the same
                                   points; NULL: not kept */
    /* another thread sets it where nobody wants the model any more; NULL: none does */
    const atomic_bool *stop;
};

/* What a scan of which a face model can be made has nevertheless, as bits. */
enum scan_warning {
    SCAN_SEVERAL,  /* more faces than one: the nearest was taken */
    SCAN_MIRRORED, /* winding, normals or the order of pixels are a mirror image's */
    SCAN_BEHIND, /* many points lie elsewhere: behind the head, on shoulders or a wall */
    SCAN_TURNED, /* farther from the scanner's view than an enrolment may be */
    SCAN_OCCLUDED, /* something covers a part of the face */
    SCAN_THINNED,  /* more points than the measure needs */
    SCAN_WARNINGS
};

/* What was found; as far as it was found on failure, the rest 0 or NAN. */
struct scan_found {
    unsigned format;                    /* cloudpoints.h */
    size_t points_read, points_dropped; /* dropped: without a value */
    size_t points_used;
    double unit_mm;   /* that was taken; 0: none */
    bool unit_found;  /* it was not given */
    double extent[3]; /* of the points, in the unit given */
    double view[16];  /* from the file's unit and axes to the frontal view in mm */
    bool found; /* the face was taken out of what it lay in; else it lies as agreed */
    /* the face's front, seen from the scanner: positive to the image's right; NAN:
     * where the scanner was is unknown */
    double yaw_deg;
    double pitch_deg, roll_deg; /* likewise; positive upwards, and anticlockwise */
    double occluded; /* share of the mean face's cells that something covers, 0..1 */
    /* share of the points of neither the face nor what covers it, 0..1 */
    double elsewhere;
    uint32_t faces;    /* in the cloud */
    struct gate gate;  /* the evidence for a face, and the least that is wanted here */
    unsigned warnings; /* 1 << enum scan_warning */
    char digest[65];   /* of the set of points as they were read; set by sample_build() */
};

/* scan_build(c, o, w, out, found): the model of the face in c.
 * c      as cloudfile_read() left it, c->unit_mm 0: to be found.  Afterwards the points of the
 *        face alone, in the frontal view and mm; index as before has their places among those
 *        read.  On failure unspecified, but still to be freed
 * out    as in face_build()
 * bad    as in face_build(), of the points before; may be NULL
 * A scan that is plainly one uncovered frontal face, of SCAN_FULL points at most, is left as
 * it is, but for its unit.  Of all others the points of the face become a template, and nothing
 * else of the scan is kept: db/FORMAT.md, "What is kept of the raw scan", has why that is enough.
 * Which points these are depends on their order by rounding only.  Memory: 16 bytes a point,
 * and what find_face() takes, freed at the end.
 * Returns ST_OK; as face_build(); ST_ENOFACE: none was found; ST_ESEVERAL, ST_EMIRRORED:
 * enrolment alone; ST_EBUSY: o->stop was set, which is asked before each step of the search. */
enum status scan_build(struct cloudpoints *c, const struct scan_options *o,
                       struct face_work *w, struct face *out, size_t *bad,
                       struct scan_found *found);

/* scan_warning_name(k): "several_faces", "mirrored", ...; static. */
const char *scan_warning_name(enum scan_warning k);

#endif
