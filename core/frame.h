/* frame.h -- the canonical frame of a face: nose tip at the origin, the symmetry plane at
 * x = 0, upright; so that u(x, y), the modes and the regions mean the same place on every
 * face.  Found by laying the face on the model's mean face, which has these properties:
 * steadier than any landmark of a single scan.  Found once, at enrolment, and stored. */
#ifndef CORE_FRAME_H
#define CORE_FRAME_H
#include "align.h"
#include "align_pose.h"
#include "grid.h"
#include "surface.h"

struct model; /* model.h */

/* The mean face as a surface to lay others on.  All zero is an empty one. */
struct frame_mean {
    struct surface surface;
    float rigid[GRID_N];  /* for registrations: where a face keeps its shape, 0..1 */
    float height[GRID_N]; /* mm; NAN off the face */
    uint32_t mean_id;     /* model_mean_id() */
};

/* frame_mean_make(m, w, out): once for a model.  Returns ST_OK, ST_ENOMEM; ST_EDEGENERATE,
 * ST_EINVAL when the model's mean is no surface. */
enum status frame_mean_make(const struct model *m, struct scratch *s,
                            struct frame_mean *out);
void frame_mean_free(struct frame_mean *mean);

struct frame {
    struct align_pose pose; /* face -> canonical, mm */
    uint32_t mean_id;       /* of the mean face it was found by; 0: not found yet */
    double cost_mm;         /* mean distance from the mean face there (capped, L1) */
    double within;          /* share of the face's points over the mean face */
    double likeness;        /* frame_likeness() there */
};

/* frame_find(mean, face, w, out): Returns ST_OK, ST_ENOMEM.  Cost: a fraction of a
 * triangulation.  (A decoded template has pose and mark alone; the rest is 0.) */
enum status frame_find(const struct frame_mean *mean, const struct surface *face,
                       struct align_work *w, struct frame *out);

/* frame_likeness(mean, face, pose): is it shaped like a face, -1..1: the correlation, over
 * the cells that both cover, of its relief with the mean face's.  The relief is what the
 * best-fitting quadric z(x, y) leaves of the heights (least squares, each on its own): nose,
 * orbits and lips.  Without that any egg, cylinder or cone would be like a face, because
 * most of a face's depth is that of an egg.  0: there is no relief.
 * NAN where fewer than FRAME_LIKENESS_CELLS, a third of a face, are common: a part may be
 * laid on another part, and tells nothing.  O(nv); nothing is allocated. */
double frame_likeness(const struct frame_mean *mean, const struct surface *face,
                      const struct align_pose *pose);

#endif
