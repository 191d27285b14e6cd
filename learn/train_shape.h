/* train_shape.h -- the basis of shape (model.h): how the faces of a collection differ from
 * their mean. */
#ifndef LEARN_TRAIN_SHAPE_H
#define LEARN_TRAIN_SHAPE_H
#include "status.h"

struct errinfo;   /* errinfo.h */
struct model;     /* model.h */
struct train_set; /* train_set.h */

/* train_shape(set, m, e): set m->shape from the heights of all scans of the set about m's
 * mean face, in the frames that it gave them, and from their mirror images.  All scans, not
 * the enrolled ones alone: they bring the expressions.  Cells off the mean face are not used.
 * Cost: learn_modes() of TRAIN_SHAPE_MODES modes.
 * Returns ST_OK; ST_EINVAL fewer scans than twice the modes; ST_ENOMEM. */
#define TRAIN_SHAPE_MODES 40
enum status train_shape(const struct train_set *set, struct model *m, struct errinfo *e);

#endif
