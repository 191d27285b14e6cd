/* frames.h -- the frames of one capture session become one face: which is the base, which others
 * show the same person and can be laid on it, and does the fused face pass the gate?
 * A frame of another person is told by the score against the base, as any two scans are
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
    enum status st; /* as struct surface_frame has it */
    bool built;     /* face is one */
    double score;
    struct fuse_place at;
    struct surface_face face;
    struct surface_found found; /* but points and kept, which are the caller's */
};

/* One session.  All zero but w and how is an empty one. */
struct frames {
    struct surface_work *w;
    struct scan_options
        how; /* of a frame: frame unless it is the only one; not search, near */
    uint32_t n, base;
    bool placed;           /* near is known */
    struct scan_near near; /* where the first face was found */
    struct frames_one one[SURFACE_FRAMES_MAX];
};

/* frames_add(f, c, bad): builds the next frame from c, which is afterwards as scan_build() leaves
 * it; bad as there.  A frame without a face is no failure: f->one[f->n - 1].st says why.
 * f->n must be less than SURFACE_FRAMES_MAX.  Returns ST_OK; ST_ENOMEM, ST_EBUSY. */
enum status frames_add(struct frames *f, struct cloudpoints *c, size_t *bad);

/* frames_fuse(f, out, found): the face of all frames, as surface_fuse() says; out as in
 * face_build().  Of the frames f->base, st, score and at are set.
 * Returns as surface_fuse(). */
enum status frames_fuse(struct frames *f, struct surface_face *out,
                        struct surface_found *found);

void frames_free(struct frames *f); /* the faces of f, which is empty again */

#endif
