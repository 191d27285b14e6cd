#include "relief.h"

#include <math.h>
#include <string.h>

#define TURN 6.283185307179586

static void add_bump(struct relief *f, double x, double y, double sx, double sy, double h)
{
    f->bump[f->bumps++] = (struct relief_bump){x, y, sx, sy, h};
}

void relief_draw(uint64_t seed, struct relief *out)
{
    struct draw r = draw_stream(seed, 1, 0);
    const double low = draw_uniform(&r, 8, 60), high = low * draw_uniform(&r, 1.2, 4);
    const double slope = draw_uniform(&r, 0.01, 0.06);

    memset(out, 0, sizeof *out);
    out->across = draw_uniform(&r, 55, 90);
    out->up = out->across * draw_uniform(&r, 0.9, 1.5);
    out->depth = draw_uniform(&r, 5, 70);
    out->power = draw_uniform(&r, 0.9, 1.7);
    for (int i = 0; i < 3; i++)
        out->saddle[i] = 8 * draw_normal(&r);
    out->even = seed % 3 != 0;
    for (uint32_t i = 0; i < 24; i++) {
        const double mm = low * pow(high / low, draw_uniform(&r, 0, 1));
        const double way = draw_uniform(&r, 0, TURN);

        out->wave[i].kx = TURN / mm * cos(way);
        out->wave[i].ky = TURN / mm * sin(way);
        out->wave[i].phase = draw_uniform(&r, 0, TURN);
        out->wave[i].h = slope * mm * draw_uniform(&r, 0.3, 1);
    }
    out->waves = 24;
    if (seed / 3 % 3 >= 1) { /* a hump */
        const double x = draw_uniform(&r, -5, 5), y = draw_uniform(&r, -15, 15);
        const double sx = draw_uniform(&r, 7, 18), sy = draw_uniform(&r, 9, 28);

        add_bump(out, x, y, sx, sy, draw_uniform(&r, 8, 30));
    }
    /* That goes up into a ridge, with hollows beside it. */
    for (int side = -1; seed / 3 % 3 == 2 && side <= 1; side++) {
        const double x = side * draw_uniform(&r, 22, 40);
        const double y = draw_uniform(&r, 15, 45), sx = draw_uniform(&r, 6, 16);
        const double sy = draw_uniform(&r, 8, 22);

        add_bump(out, x, y, sx, sy,
                 side == 0 ? draw_uniform(&r, 4, 14) : draw_uniform(&r, -14, -2));
    }
}

static double waves(const struct relief *f, double x, double y)
{
    double z = 0;

    for (uint32_t i = 0; i < f->waves; i++)
        z += f->wave[i].h * cos(f->wave[i].kx * x + f->wave[i].ky * y + f->wave[i].phase);
    return z;
}

double relief_height(const struct relief *f, double x, double y)
{
    const double u = x / f->across, v = y / f->up;
    double z = -f->depth * pow(u * u + v * v, f->power) + f->saddle[0] * u * u +
               f->saddle[1] * u * v + f->saddle[2] * v * v;

    if (f->waves > 0)
        z += waves(f, x, y);
    if (f->waves > 0 && f->even < 1)
        z += (1 - f->even) / 2 * (waves(f, -x, y) - waves(f, x, y));
    for (uint32_t i = 0; i < f->bumps; i++) {
        const struct relief_bump *b = &f->bump[i];
        const double p = (x - b->x) / b->sx, q = (y - b->y) / b->sy;

        z += b->h * exp(-(p * p + q * q) / 2);
    }
    return z;
}

size_t relief_sample(const struct relief *f, uint32_t points, double noise,
                     struct draw *r, struct dvec3 *out)
{
    size_t n = 0;

    for (uint64_t tries = 0; n < points && tries < 12 * (uint64_t)points; tries++) {
        const double x = draw_uniform(r, -f->across, f->across);
        const double y = draw_uniform(r, -f->up, f->up), u = x / f->across, v = y / f->up;
        double dx, dy, z;

        if (u * u + v * v > 1)
            continue;
        z = relief_height(f, x, y);
        dx = 2 * (relief_height(f, x + 0.5, y) - z);
        dy = 2 * (relief_height(f, x, y + 0.5) - z);
        if (dx * dx + dy * dy > 15)
            continue;
        out[n++] = (struct dvec3){x, y, z + noise * draw_normal(r)};
    }
    return n;
}
