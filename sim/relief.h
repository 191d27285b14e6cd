/* relief.h -- height fields of an egg or another quadric, with Gaussian bumps and waves on it:
 * surfaces that are no faces although they may have a hump where a nose would be. */
#ifndef TOOLS_RELIEF_H
#define TOOLS_RELIEF_H
#include <stddef.h>
#include <stdint.h>
#include "draw.h"
#include "vec.h"

#define RELIEF_BUMPS 12
#define RELIEF_WAVES 40

struct relief {
    double across, up; /* half axes of the oval outline, mm */
    double depth; /* of the egg, mm: it falls by depth (x^2 + y^2)^power at the outline */
    double power;
    double saddle[3]; /* mm at the outline: of x^2, xy, y^2 of the unit circle */
    struct relief_bump {
        double x, y, sx, sy, h; /* centre, widths, height: mm */
    } bump[RELIEF_BUMPS];
    uint32_t bumps;
    struct {
        double kx, ky, phase, h;
    } wave[RELIEF_WAVES];
    uint32_t waves;
    /* 1: waves as drawn; 0: their part even in x alone, as in a symmetric thing */
    double even;
};

/* relief_draw(seed, out): waves of a band of lengths, 100 to 5 mm; of two in three besides a
 * hump or a ridge in the middle; of one in three the two sides are alike. */
void relief_draw(uint64_t seed, struct relief *out);

double relief_height(const struct relief *f, double x, double y);

/* relief_sample(f, points, noise, r, out): the points of a scan, uniform in x and y, without
 * what is steeper than 75 degrees.  Returns how many. */
size_t relief_sample(const struct relief *f, uint32_t points, double noise,
                     struct draw *r, struct dvec3 *out);

#endif
