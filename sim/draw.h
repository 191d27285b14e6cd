/* draw.h -- random numbers of the simulators: splitmix64, the same on every machine, and a bell
 * curve of twelve uniform numbers, so that no seed depends on libm. */
#ifndef SIM_DRAW_H
#define SIM_DRAW_H
#include <stdint.h>

struct draw {
    uint64_t x;
};

/* draw_stream(a, b, purpose): Returns a stream for this purpose: the streams of other purposes do not
 * depend on how many numbers are drawn from it. */
struct draw draw_stream(uint64_t a, uint64_t b, uint64_t purpose);

uint64_t draw_next(struct draw *r);
double draw_uniform(struct draw *r, double low, double high);
double draw_normal(struct draw *r); /* mean 0, variance 1, within +-6 */

#endif
