/* train_mean.h -- the mean face of a collection. */
#ifndef LEARN_TRAIN_MEAN_H
#define LEARN_TRAIN_MEAN_H
#include "status.h"

struct errinfo;
struct model;     /* model.h */
struct train_set; /* train_set.h */

/* train_mean(set, threads, m, e): m->mean, and the frames of all of the set's faces by it: from each
 * enrolled face's principal axes and nose at first, then by laying all on their mean,
 * TRAIN_MEAN_ROUNDS times.  The mean is symmetric, its nose tip at the origin, and upright:
 * 60 mm above and below the nose tip it is as high.  Everything else in m becomes neutral:
 * no modes, u = 1.  Returns ST_OK; ST_EINVAL: nothing in common; ST_ENOMEM. */
#define TRAIN_MEAN_ROUNDS 5
enum status train_mean(const struct train_set *set, unsigned threads, struct model *m,
                       struct errinfo *e);

#endif
