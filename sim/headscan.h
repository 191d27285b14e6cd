/* headscan.h -- a head as scanners deliver it: views, a depth camera's grid, points all round,
 * with covers, in any unit and axes.  Everything follows from the head and the seed. */
#ifndef SIM_HEADSCAN_H
#define SIM_HEADSCAN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "head.h"
#include "headcover.h"
#include "vec.h"

/* What a scan of a head (headscan.h) is to be, and what it is. */

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

/* The kinds by name: head, bust, round, half, depth, grid, behind, two, and the covers.
 * headscan_kind(k, seed, crop, o): the kind's options, drawn by the seed. */
#define HEADSCAN_KINDS 15
const char *headscan_name(unsigned kind);
void headscan_kind(unsigned kind, uint64_t seed, bool crop, struct headscan_options *o);

/* headscan_render(h, other, o, out): h in the canonical frame, measured; other: the second
 * head (may be h).  out: released by headscan_free(). */
void headscan_render(const struct head *h, const struct head *other,
                     const struct headscan_options *o, struct headscan *out);
void headscan_free(struct headscan *s);

#endif
