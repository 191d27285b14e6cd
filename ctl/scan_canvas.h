/* scan_canvas.h -- a scan as pixels: the points as they were delivered, and the face that was
 * found among them, from the front. */
#ifndef CTL_SCAN_CANVAS_H
#define CTL_SCAN_CANVAS_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

struct face;       /* face.h */
struct frame_mean; /* frame.h */
struct scan_found; /* scan.h */

/* What is drawn. */
struct scan_drawn {
    const struct dvec3 *at; /* [n] in the file's unit and axes */
    const uint8_t *used;    /* [n] 1: of the face, in the model of it */
    size_t n;
    const struct scan_found *found;
    const struct face *face; /* NULL: refused */
    const struct frame_mean *mean;
};

struct scan_canvas {
    uint32_t w, h;      /* pixels; the first row is the lowest */
    double x, y, step;  /* the middle of the first pixel, and how far apart they are */
    uint8_t (*rgba)[4]; /* [h * w] alpha 0: nothing is there */
};

/* scan_canvas_points(d, out): all points, seen along the file's z axis, the larger z before
 * the smaller: those of the face by their depth, the others grey and behind them; without a
 * face all by their depth.  Points far from all others, or from the face, may lie outside.
 * scan_canvas_face(d, out): the surface of the face in the canonical frame (grid.h), mm, lit
 * from above and coloured by its depth; without a face the points, if one was found.
 * Where the surface has a hole on the mean face: SCAN_CANVAS_COVERED if something covers the
 * face, and points stand there that were left out; else SCAN_CANVAS_EMPTY.
 * out  released by scan_canvas_free(); empty on failure
 * Return ST_OK, ST_ENOMEM. */
enum status scan_canvas_points(const struct scan_drawn *d, struct scan_canvas *out);
enum status scan_canvas_face(const struct scan_drawn *d, struct scan_canvas *out);
void scan_canvas_free(struct scan_canvas *c);

#define SCAN_CANVAS_COVERED 0xf08a24 /* RGB */
#define SCAN_CANVAS_EMPTY   0xd4d4d4

#endif
