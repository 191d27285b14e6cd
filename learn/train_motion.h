/* train_motion.h -- the basis of motion (model.h) from a collection with known poses. */
#ifndef LEARN_TRAIN_MOTION_H
#define LEARN_TRAIN_MOTION_H
#include "status.h"
#include "vec.h"

struct errinfo;
struct model;     /* model.h */
struct train_set; /* train_set.h */

/* train_motion_centre(set): the point about which all heads were turned, in the scanner's
 * coordinates before the shift, mm.  A manifest does not state it, and an error of a few
 * centimetres is millimetres of shift between two scans.  It is found by least squares from
 * where the faces' frames have the noses; in directions that the scans do not determine it
 * is the origin.  O(nscan). */
struct dvec3 train_motion_centre(const struct train_set *set);

/* train_motion(set, threads, m, e): set m->motion from the gaps of mated pairs at their true
 * poses: of each scan with the subject's next TRAIN_MOTION_PAIRS.  The set's poses are known
 * and its frames found by m's mean.  The result does not depend on the number of threads.
 * Cost: less than a comparison for each pair, and learn_modes().
 * Returns ST_OK; ST_EINVAL too few pairs; ST_ENOMEM. */
#define TRAIN_MOTION_PAIRS 12
enum status train_motion(const struct train_set *set, unsigned threads, struct model *m,
                         struct errinfo *e);

#endif
