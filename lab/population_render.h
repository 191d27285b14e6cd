/* population_render.h -- a population from a morphable model (morphable.h): random people, and
 * random expressions of theirs, rendered (render.h). */
#ifndef LAB_POPULATION_RENDER_H
#define LAB_POPULATION_RENDER_H
#include "population.h"
#include "status.h"

struct errinfo;   /* errinfo.h */
struct morphable; /* morphable.h */

#define POPULATION_RENDER_PEOPLE      3000
#define POPULATION_RENDER_EXPRESSIONS 5000

/* population_render(m, threads, p, e): the mean face is that of the rendered people, over the cells
 * that nearly all of them cover and where it is not steep.
 *     W = 2 E[d d'] of the gaps d between a neutral face and an expression + smooth fields
 *     B = 0.49 of the covariance of neutral faces + a smooth field
 * since real people's scans differ by more than the model's expressions, and the model's random
 * people more than real ones; the fields stand for what neither shows.  The factors were chosen on
 * scans of real people (docs/model.md).
 * threads  0: one for each core; the result does not depend on it
 * About 50 s of one core.  Returns ST_OK; ST_ENOTFACE too little of a face; ST_ENOMEM. */
enum status population_render(const struct morphable *m, unsigned threads,
                              struct population *p, struct errinfo *e);

#endif
