#include "sought.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lab.h"
#include "draw.h"
#include "relief.h"
#include "solid.h"

#define NUMBERS 66
#define BALLS   10

/* Numbers of order 1 -> an egg and its bumps. */
static void build_relief(const double *x, struct relief *f)
{
    memset(f, 0, sizeof *f);
    f->across = 68 * exp(0.2 * tanh(x[0]));
    f->up = 85 * exp(0.2 * tanh(x[1]));
    f->depth = 35 + 15 * x[2];
    f->power = 1.2 + 0.3 * tanh(x[3]);
    f->saddle[0] = 6 * x[4];
    f->saddle[2] = 6 * x[5];
    f->bumps = RELIEF_BUMPS;
    for (int i = 0; i < RELIEF_BUMPS; i++) {
        const double *b = &x[6 + 5 * i];

        f->bump[i] =
            (struct relief_bump){30 * b[0], 40 * b[1], 13 * exp(0.6 * tanh(b[2])),
                                 13 * exp(0.6 * tanh(b[3])), 7 * b[4]};
    }
}

static void build_balls(const double *x, struct solid *s)
{
    memset(s, 0, sizeof *s);
    solid_add(s, SOLID_BALL, 0, 0, -30, 65 + 8 * tanh(x[60]), 85 + 12 * tanh(x[61]),
              55 + 12 * tanh(x[62]), 0);
    for (int i = 0; i < BALLS; i++) {
        const double *b = &x[6 * i];
        const double a = 24 * exp(0.7 * tanh(b[3]));

        solid_add(s, SOLID_BALL, 30 * b[0], 40 * b[1], 5 + 15 * b[2], a,
                  a * exp(0.5 * tanh(b[4])), a * exp(0.5 * tanh(b[5])), 15)
            ->carved = i >= BALLS - 2;
    }
}

static size_t scan(uint64_t seed, const double *x, struct dvec3 *out)
{
    struct draw r = draw_stream(seed, 0, 5);

    if (seed % 2 == 0) {
        struct relief f;

        build_relief(x, &f);
        return relief_sample(&f, SOUGHT_POINTS, 0.15, &r, out);
    } else {
        static const struct solid_view front = {.turn = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                                .wide = 85,
                                                .points = SOUGHT_POINTS,
                                                .noise = 0.15};
        struct solid s;

        build_balls(x, &s);
        return solid_scan(&s, &front, &r, out);
    }
}

size_t sought_find(uint64_t seed, int steps,
                   double (*evidence)(void *of, struct dvec3 *pts, size_t n), void *of,
                   struct dvec3 *out)
{
    struct draw r = draw_stream(seed, 0, 4);
    double x[NUMBERS], y[NUMBERS], most, size = 0.5;
    struct dvec3 *pts = lab_alloc(SOUGHT_POINTS, sizeof *pts);

    for (int i = 0; i < NUMBERS; i++)
        x[i] = draw_normal(&r);
    most = evidence(of, pts, scan(seed, x, pts));
    for (int k = 0; k < steps; k++) {
        const double share = draw_uniform(&r, 0, 1) < 0.5 ? 0.05 : 0.3;
        double e;

        for (int i = 0; i < NUMBERS; i++) {
            const double by = size * draw_normal(&r);

            y[i] = x[i] + (draw_uniform(&r, 0, 1) < share ? by : 0);
        }
        e = evidence(of, pts, scan(seed, y, pts));
        size = fmin(fmax(size * (e > most ? 1.5 : 0.94), 0.05), 1); /* the rule of 1/5 */
        if (e >= most) {
            most = e;
            memcpy(x, y, sizeof x);
        }
    }
    free(pts);
    return scan(seed, x, out);
}
