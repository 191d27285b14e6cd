/* train_mean.h -- the mean face of a collection. */
#ifndef LEARN_TRAIN_MEAN_H
#define LEARN_TRAIN_MEAN_H
#include "grid.h"
#include "status.h"

struct align_pose; /* align_pose.h */
struct errinfo;    /* errinfo.h */
struct model;      /* model.h */
struct surface;    /* surface.h */
struct train_set;  /* train_set.h */

/* train_mean(set, threads, m, e): set m->mean, and the frames of all faces of the set: first
 * by each enrolled face's principal axes and nose, then by alignment to the mean,
 * TRAIN_MEAN_ROUNDS times.  The mean is symmetric, its nose tip is at the origin, and it is
 * upright: as high 60 mm above the nose tip as 60 mm below.  Everything else in m becomes
 * neutral: no modes, u = 1.
 * Returns ST_OK; ST_EINVAL the faces have no surface in common; ST_ENOMEM. */
#define TRAIN_MEAN_ROUNDS 5
enum status train_mean(const struct train_set *set, unsigned threads, struct model *m,
                       struct errinfo *e);

/* train_mean_map(s, pose, z): the mean height (mm) of s in each cell of the frame that pose
 * takes it to; NAN where less than LEARN_COVERED mm^2 of the cell is covered.  O(nv). */
void train_mean_map(const struct surface *s, const struct align_pose *pose,
                    float z[GRID_N]);

#endif
