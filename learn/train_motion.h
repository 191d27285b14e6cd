/* train_motion.h -- the basis of motion (model.h) from a collection that knows its poses. */
#ifndef LEARN_TRAIN_MOTION_H
#define LEARN_TRAIN_MOTION_H
#include "status.h"
#include "vec.h"

struct errinfo;
struct model;     /* model.h */
struct train_set; /* train_set.h */

/* train_motion_centre(set): the point that all heads were turned about, in the scanner's
 * coordinates before the shift, mm.  A manifest does not tell it, and a few centimetres of
 * it are millimetres of shift between two scans.  It is what explains best, by least
 * squares, where the noses are by the faces' frames; along what no scan tells, it stays at
 * the origin.  O(nscan). */
struct dvec3 train_motion_centre(const struct train_set *set);

/* train_motion(set, threads, m, e): m->motion from the gaps, at the true poses, of all pairs
 * of scans of one subject (of each scan with the TRAIN_MOTION_PAIRS next ones).  The set's
 * poses are known, its frames found by m's mean.  The same on any number of threads.
 * Cost: less than a comparison a pair, and learn_modes().
 * Returns ST_OK; ST_EINVAL: too few pairs; ST_ENOMEM. */
#define TRAIN_MOTION_PAIRS 12
enum status train_motion(const struct train_set *set, unsigned threads, struct model *m,
                         struct errinfo *e);

#endif
