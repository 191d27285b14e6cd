/* frames.h -- the frames of one capture session become one face: chooses the base and the frames that
 * show the same person and can be laid on it, and judges the fused face.
 * A frame of another person is recognised by its score against the base, like any two scans
 * (core/face/ratio.h). */
#ifndef CORE_FRAMES_H
#define CORE_FRAMES_H
#include <stdbool.h>
#include <stdint.h>
#include "face.h"
#include "fuse.h"
#include "surface_scan.h"
#include "scan.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */

struct frames_one {
    enum status st; /* status of struct surface_frame */
    bool built;     /* true: face is a face */
    double score;
    struct fuse_place at;
    bool there[GRID_N]; /* the base's cells that the frame has measured */
    struct surface_gain adds;
    struct surface_face face;
    struct surface_found found; /* the caller sets points and kept */
};

/* One session.  An empty one is all zero except for w and how. */
struct frames {
    struct surface_work *w;
    struct scan_options
        how; /* options of a frame: frame unless it is the only one; not search, near */
    uint32_t n, base;
    bool placed;           /* true: near is known */
    struct scan_near near; /* place of the first face */
    struct frames_one one[SURFACE_FRAMES_MAX];
};

/* frames_add(f, c, bad): Builds the next frame from c.  A frame without a face is no failure:
 * f->one[f->n - 1].st has the reason.
 *   f       f->n is less than SURFACE_FRAMES_MAX
 *   c, bad  as in scan_build()
 * Returns ST_OK, ST_ENOMEM, ST_EBUSY. */
enum status frames_add(struct frames *f, struct cloudpoints *c, size_t *bad);

/* frames_fuse(f, out, found): Fuses the faces of all frames (surface_fuse()).  Sets f->base, and st,
 * score, at and adds of the frames.
 *   out  as in face_build()
 * Returns as surface_fuse(). */
enum status frames_fuse(struct frames *f, struct surface_face *out,
                        struct surface_found *found);

void frames_free(struct frames *f); /* resets f to the empty state */

#endif
