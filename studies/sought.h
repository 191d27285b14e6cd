/* sought.h -- surfaces that are no faces, sought against the gate: generic bumps on an egg, or
 * balls that run into one another, changed at random as long as the gate's evidence grows.
 * Nothing of the model's own modes goes into them. */
#ifndef STUDIES_SOUGHT_H
#define STUDIES_SOUGHT_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

#define SOUGHT_POINTS 3000

/* sought_find(seed, steps, evidence, of, out): the surface with the most evidence after so many
 * steps from where the seed begins; even seeds: 12 Gaussian bumps on an egg; odd: 10 balls,
 * two of them taken away.  out has room for SOUGHT_POINTS.  Returns how many points.
 * evidence(of, pts, n): higher is more like a face; may change the points. */
size_t sought_find(uint64_t seed, int steps,
                   double (*evidence)(void *of, struct dvec3 *pts, size_t n), void *of,
                   struct dvec3 *out);

#endif
