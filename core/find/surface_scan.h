/* ---- surface_scan.h: the points of a scan, and the report on them */
#ifndef CORE_SURFACE_SCAN_H
#define CORE_SURFACE_SCAN_H
#include "../face/surface_face.h"

/* Limits of what is measured of a scan. */
#define SURFACE_FARTHEST_MM   16777.216 /* the largest coordinate: 2^24 um */
#define SURFACE_FOCAL_MOST    1.085     /* surface_found.focal_times of a face */
#define SURFACE_FOCAL_LEAST   0.85
#define SURFACE_STEP_MM       1.2  /* between neighbouring depths of the sensor */
#define SURFACE_OCCLUDED_MOST 0.40 /* share of an enrolled face */

enum {
    /* The points are one face as its scanner saw it: x to the image's right, y up, z towards
     * the scanner, yaw within 30 degrees, pitch and roll within 20.  The library does not search,
     * rotate or crop.  Without this flag it finds, crops and rotates the face, whatever lies
     * around it and whatever its pose. */
    SURFACE_FRONTAL = 1,
    /* The stricter gate judges the face: for faces that others are compared with. */
    SURFACE_ENROLMENT = 2,
    /* x and y were computed from a depth image, by a focal length that may be wrong: the library
     * also checks the proportions of the face. */
    SURFACE_PINHOLE = 4
};

/* A cancellation flag: the library calls wanted(arg) before each step of the search, and ends the
 * build with SURFACE_ESTOPPED if it returns other than 0. */
struct surface_stop {
    int (*wanted)(const void *arg);
    const void *arg;
};

/* The points of a scan, in any order; all borrowed for the call. */
struct surface_cloud {
    /* (x, y, z); those with a NaN or an infinity are ignored, with SURFACE_FRONTAL refused */
    const double (*points)[3];
    /* normals of any length, (0, 0, 0): unknown; NULL: none.  They tell front from back, and a
     * mirror image */
    const double (*normals)[3];
    size_t n;
    /* size of a depth image, whose points go row by row from the upper left, n = width height;
     * 0: no image */
    uint32_t width, height;
    /* millimetres per unit of the points; 0: to be found, with SURFACE_FRONTAL 1 */
    double unit_mm;
    uint32_t flags; /* SURFACE_FRONTAL | SURFACE_ENROLMENT | SURFACE_PINHOLE */
    /* [n] pixel numbers, ascending, if only some points of an image are given; NULL: all are */
    const uint32_t *place;
    const struct surface_stop *stop; /* NULL: none */
    /* [n] buffers, both or neither; NULL: not wanted.  kept receives the surface_found.kept points
     * that the face was built from, in the frontal view and mm; kept_place their numbers among
     * the points given, or in the image.  kept may be points, which is then overwritten, also on
     * failure, and costs no copy; kept_place may be place */
    double (*kept)[3];
    uint32_t *kept_place;
};

/* Remarks on a scan that a face was built from: bits 1 << surface_warning. */
enum surface_warning {
    SURFACE_SEVERAL,  /* more than one face: the nearest was taken */
    SURFACE_MIRRORED, /* normals or the order of pixels are those of a mirror image */
    SURFACE_BEHIND,   /* many points are outside the face; they were ignored */
    SURFACE_TURNED,   /* farther from the scanner's view than an enrolment may be */
    SURFACE_OCCLUDED, /* something covers a part of the face */
    SURFACE_THINNED,  /* more points than the measure needs */
    SURFACE_STEPPED,  /* step_mm above SURFACE_STEP_MM: its noise is that of the step */
    SURFACE_FOCAL,    /* focal_times beyond SURFACE_FOCAL_MOST or _LEAST */
    SURFACE_WARNINGS
};

/* Returns "several_faces", "mirrored", ..., static; NULL for another value. */
SURFACE_API const char *surface_warning_name(enum surface_warning warning);

/* The report on a scan.  On failure the members are set as far as the search came; the rest is 0. */
struct surface_found {
    size_t points;      /* number of points with finite coordinates */
    size_t points_used; /* number of points of the face; 0 on failure */
    size_t kept;    /* number of points in surface_cloud.kept; unspecified on failure */
    size_t bad;     /* number of the offending point for SURFACE_ENOTFINITE and _ERANGE */
    double unit_mm; /* the unit used; 0: none */
    int unit_found; /* 1: the caller gave no unit */
    int cropped;    /* 1: the face was cut out of the points; 0: it lies as given */
    uint32_t faces; /* number of faces in the cloud */
    uint32_t warnings; /* bits 1 << surface_warning */
    double extent[3];  /* size of the box around the points, in their unit */
    /* similarity from the points' unit and axes to the frontal view of the face in mm */
    double view[16];
    /* pose of the face before a scanner that looks along z: positive to the face's own left (the image's
     * right), upwards, and anticlockwise in the image.  Yaw and pitch do not depend on the roll, which is
     * near 90, -90 or 180 if the scanner was not upright.  NaN: unknown */
    double yaw_deg, pitch_deg, roll_deg;
    double occluded;  /* share of the face's area that something covers, 0..1 */
    double elsewhere; /* share of the points that are neither of the face nor cover it */
    /* The gate: each measure, with the least or the largest value that passes. */
    double support,
        support_wanted; /* share of the visible surface that a face explains */
    /* evidence of a face (docs/model.md): likeness + 4 eyes + 5 support + 5 detail (at most 5) +
     * 2 seen + 2 forehead (at least 0: a fringe is no fault) */
    double evidence, evidence_wanted;
    double seen, seen_wanted; /* share of a face that is there */
    /* residual of the fit of a face's shape; residual_most INFINITY: no limit for a probe */
    double residual_mm, residual_most;
    double head_size; /* 1: of adults */
    double likeness;  /* ln of the explained relief over the residual */
    double eyes;      /* likeness of both eye sockets to the mean face's, -1..1 */
    double detail;    /* fine relief, as a multiple of the mean face's */
    double forehead;  /* likeness of the forehead to a fitted face's, -1..1 */
    struct surface_quality quality; /* also of a surface that is refused */
    /* distance between neighbouring depths at the face, along the sensor's axis; 0: the depths are
     * continuous, or the cloud is rotated against the sensor's axes */
    double step_mm;
    /* with SURFACE_PINHOLE, of a face that looks at the camera: the focal length by which the face
     * has usual proportions, over the one used; its deviation over people is 0.04.  0: unknown */
    double focal_times;
    /* with SURFACE_EUNITS: about the millimetres per unit by which the points are a face, if none of
     * the usual units makes them one.  0: unknown */
    double fits_mm;
};

/* What a frame of a fused face adds to the frames before it.  All 0: nothing was fused, or it was left out. */
struct surface_gain {
    uint32_t
        place; /* in the order of fusing, from 1: the base, then the others as given */
    /* share of the fused face's area that this frame has measured, and no frame before it, 0..1 */
    double share;
    /* the same share of the area of each region's half: [0] on the face's own right, [1] on its left */
    double part[SURFACE_REGIONS][2];
    double noise_mm; /* white noise of the mean of the frames up to this one */
};

/* The report on a frame. */
struct surface_frame {
    /* SURFACE_OK: part of the fused face.  SURFACE_EPEOPLE: another person than in the base.
     * SURFACE_EAPART: cannot be laid on the base, or has too little in common with it to tell
     * whether it shows the same person.  Otherwise as surface_build() returns */
    enum surface_status status;
    double score;  /* against the base (surface_comparison); 0 of the base itself */
    double gap_mm; /* median distance from the base; INFINITY: cannot be laid on it */
    struct surface_gain adds;
    struct surface_found found;
};

#endif /* CORE_SURFACE_SCAN_H */
