#include "draw.h"

uint64_t draw_next(struct draw *r)
{
    uint64_t z = r->x += UINT64_C(0x9E3779B97F4A7C15);

    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

struct draw draw_stream(uint64_t a, uint64_t b, uint64_t purpose)
{
    struct draw r = {a};

    r.x = draw_next(&r) ^ b;
    r.x = draw_next(&r) ^ purpose;
    (void)draw_next(&r);
    return r;
}

double draw_uniform(struct draw *r, double low, double high)
{
    return low + (high - low) * ((double)(draw_next(r) >> 11) * 0x1p-53);
}

double draw_normal(struct draw *r)
{
    double sum = -6;

    for (int i = 0; i < 12; i++)
        sum += draw_uniform(r, 0, 1);
    return sum;
}
