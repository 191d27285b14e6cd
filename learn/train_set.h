/* train_set.h -- the scans that a model is learned from. */
#ifndef LEARN_TRAIN_SET_H
#define LEARN_TRAIN_SET_H

struct corpus; /* corpus.h */
struct face;   /* face.h */

struct train_set {
    const struct corpus *corpus;
    struct face *face; /* [corpus->nscan]; a scan that was refused has no points */
};

#endif
