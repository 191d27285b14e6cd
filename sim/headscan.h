/* headscan.h -- renders a head as scanners deliver it: views, a depth camera's grid, with
 * covers, in any unit.  The head and the seed determine every point. */
#ifndef SIM_HEADSCAN_H
#define SIM_HEADSCAN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "head.h"
#include "headcover.h"
#include "vec.h"

enum headscan_view {
    HEADSCAN_VIEW, /* `points` random rays over the visible surface; a crop's own points */
    HEADSCAN_GRID,  /* a ray every `step` mm */
    HEADSCAN_CAMERA /* a ray for each pixel of a depth camera, a wall behind */
};

struct headscan_options {
    uint64_t seed;
    enum headscan_view view;
    enum headcover cover;
    bool crop;               /* the head is a frontal crop: a single layer of skin */
    size_t points;           /* number of rays of a HEADSCAN_VIEW */
    double step;             /* spacing of a HEADSCAN_GRID, mm */
    double yaw, pitch, roll; /* degrees: to the image's right, up, anticlockwise */
    double distance; /* mm from the scanner, the origin; 0: the face is the origin */
    double noise;    /* deviation along the view, mm */
    double round;    /* step of the coordinates, mm; 0: none */
    double spikes;   /* share of the points thrown 4 to 40 mm off */
    double behind;   /* share of hidden points among the visible ones */
    bool shoulders;
    bool mirrored;
    bool
        down; /* a camera's axes: y down, z away from it; false: x to the image's right, y up,
                * z towards the scanner */
    double unit_mm;
};

/* Points in their unit and axes; of an organised cloud row by row, NAN: no value. */
struct headscan {
    struct dvec3 *at;
    size_t n, cap;
    uint32_t width, height; /* 0: not organised */
};

/* headscan_kind(name, seed, crop, o): Sets *o to the options of a kind, drawn by the seed: head,
 * bust, half, depth, grid, behind, glasses, mask, scarf, hand, fringe, beard, cap.
 * Returns false if there is no kind of that name. */
bool headscan_kind(const char *name, uint64_t seed, bool crop,
                   struct headscan_options *o);

/* headscan_render(h, o, out): Renders h, which lies in the canonical frame and has its spacing
 * measured.  The caller releases *out by headscan_free(). */
void headscan_render(const struct head *h, const struct headscan_options *o,
                     struct headscan *out);
void headscan_free(struct headscan *s);

#endif
