/* headspec.h -- what a scan of a head (headscan.h) is to be, and what it is. */
#ifndef TOOLS_HEADSPEC_H
#define TOOLS_HEADSPEC_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "headcover.h"
#include "vec.h"

enum headscan_view {
    HEADSCAN_VIEW, /* `points` rays at random over what is seen; of a crop its own points */
    HEADSCAN_GRID,   /* a ray every `step` mm */
    HEADSCAN_CAMERA, /* a ray for each pixel of a depth camera, a wall behind */
    HEADSCAN_ROUND   /* all points, hidden or not */
};

enum headscan_axes {
    HEADSCAN_AGREED, /* x to the image's right, y up, z towards the scanner */
    HEADSCAN_DOWN,   /* a camera's: y down, z away from it */
    HEADSCAN_Z_UP,   /* y away from the scanner */
    HEADSCAN_ANY,    /* drawn */
    HEADSCAN_AXES
};

struct headscan_options {
    uint64_t seed;
    enum headscan_view view;
    enum headcover cover;
    bool crop;     /* the head is a frontal crop: one layer of a face alone */
    size_t points; /* of a view */
    double step;
    double yaw, pitch, roll; /* degrees: to the image's right, up, anticlockwise */
    double distance;         /* from the scanner, which is the origin; 0: the face is */
    double noise;            /* along the view, mm */
    double round;            /* coordinates are multiples of it, mm; 0: no */
    double spikes;           /* share thrown 4 to 40 mm off */
    double behind;           /* share of the points that are hidden ones seen through */
    bool shoulders;
    bool two; /* another head beside it, farther away */
    bool mirrored;
    enum headscan_axes axes;
    double unit_mm;
};

/* The points in their unit and axes; of an organised cloud row by row, NAN: no value. */
struct headscan {
    struct dvec3 *at;
    size_t n, cap;
    uint32_t width, height; /* 0: not organised */
};

#endif
