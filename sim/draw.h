/* draw.h -- random numbers for what is made up: splitmix64, the same on every machine, and a
 * bell curve of twelve uniform ones, so that not even libm comes into the seeds' meaning. */
#ifndef SIM_DRAW_H
#define SIM_DRAW_H
#include <stdint.h>

struct draw {
    uint64_t x;
};

/* draw_stream(a, b, purpose): a stream for each purpose: what one takes more or less does not
 * shift the others. */
struct draw draw_stream(uint64_t a, uint64_t b, uint64_t purpose);

uint64_t draw_next(struct draw *r);
double draw_uniform(struct draw *r, double low, double high);
double draw_normal(struct draw *r); /* of mean 0 and variance 1, within +-6 */

#endif
