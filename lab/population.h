/* population.h -- a population's faces before they are cut down to the modes of a model
 * (core/face/model.h): the mean face and, about it, how gaps vary within a person and between
 * people.  It is read from a model, and adapted to scans (population_scans.h). */
#ifndef LAB_POPULATION_H
#define LAB_POPULATION_H
#include "grid.h"
#include "model.h"
#include "spread.h"
#include "status.h"

#define POPULATION_MOTIONS 6

struct population {
    float mean
        [GRID_N]; /* height of the mean face, mm, symmetric; NAN: the cell is not in use */
    float normal_z[GRID_N]; /* scales heights to gaps */
    float motion[POPULATION_MOTIONS]
                [GRID_N]; /* gaps by the prior's motions of the mean face
                                                 (encode.h) */
    struct spread_cells cells;
    struct spread change;   /* W: change of one scan within a person */
    struct spread identity; /* B: between people */
    struct spread shape;    /* faces with expressions, as wide as a fit allows */
};

/* population_read(m, p): Computes the population that the model m describes.  The mean face is made
 * symmetric; a cell is in use if it and its mirror image have a height.
 * Returns ST_OK; ST_EINVAL fewer than MODEL_FACE_MIN cells are in use; ST_ENOMEM.  On failure p is
 * empty. */
enum status population_read(const struct surface_model *m, struct population *p);

/* population_copy(from, to): Returns ST_OK; ST_ENOMEM, to is empty. */
enum status population_copy(const struct population *from, struct population *to);
void population_free(struct population *p); /* resets p to the empty state */

/* population_still(p, s): Removes from s the variation that equals a motion of the mean face. */
void population_still(const struct population *p, struct spread *s);

/* population_model(p, m): Sets m's mean, change, identity and shape to the leading modes of p.
 * change    the leading modes of W
 * identity  the leading modes of B against W, noise of 1 mm and motion, which scans show best
 * shape     the leading modes of p->shape
 * Each has as many modes as MODEL_MODES and the cells allow, and at most POPULATION_CHANGE,
 * POPULATION_IDENTITY and POPULATION_SHAPE.
 * Cost: about 0.5 s.  Returns ST_OK; ST_EINVAL: a number is not finite; ST_ENOMEM. */
#define POPULATION_CHANGE   100
#define POPULATION_IDENTITY 100
#define POPULATION_SHAPE    88
enum status population_model(const struct population *p, struct surface_model *m);

#endif
