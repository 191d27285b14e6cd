/* bench_search: what a search costs: preparing a probe, and scanning an index of descriptors of random people of the
 * complete face's classes.  Prints ms and ns a descriptor. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "clouds.h"
#include "draw.h"
#include "face.h"
#include "libsurface.h"
#include "timing.h"

#define POINTS 3000
#define ROUNDS 9
#define MOST   160

static struct surface_hit hit[MOST];

/* Descriptors whose coefficients are spread as those of people: 2.5 units of 0.4 deviations. */
static void fill(struct surface_index *x, uint32_t n, struct draw *rng)
{
    for (uint32_t i = 0; i < n; i++) {
        unsigned char d[SURFACE_DESCRIPTOR];

        d[0] = 1;
        for (int k = 1; k < SURFACE_DESCRIPTOR; k++)
            d[k] = (unsigned char)(int8_t)(2.5 * draw_normal(rng));
        if (surface_index_add(x, d) == SURFACE_NOWHERE)
            exit(1);
    }
}

static double median(double *ms)
{
    for (int i = 1; i < ROUNDS; i++)
        for (int k = i; k > 0 && ms[k - 1] > ms[k]; k--) {
            const double t = ms[k];

            ms[k] = ms[k - 1];
            ms[k - 1] = t;
        }
    return ms[ROUNDS / 2];
}

int main(void)
{
    static struct dvec3 pts[2 * POINTS];
    static const uint32_t size[] = {0, 10000, 90000, 900000}; /* more each time */
    struct surface_work *w = surface_work_new(NULL);
    struct surface_index *x = surface_index_new();
    struct draw rng = draw_stream(1, 0, 0);
    struct surface_face face;
    double none = 0;
    uint32_t all = 0;

    if (w == NULL || x == NULL ||
        face_build(pts, clouds_scan(1, 0, POINTS, pts), w, &face, NULL) != ST_OK)
        return 1;
    for (size_t s = 0; s < sizeof size / sizeof *size; s++) {
        double ms[ROUNDS], t;
        size_t n;

        fill(x, size[s], &rng);
        all += size[s];
        for (int i = 0; i < ROUNDS; i++) {
            t = timing_now_ms();
            if (surface_search(w, x, &face, NULL, -1e9, MOST, hit, &n) != SURFACE_OK)
                return 1;
            ms[i] = timing_now_ms() - t;
        }
        t = median(ms);
        none = all == 0 ? t : none;
        (void)printf("search %7" PRIu32
                     " descriptors  %8.2f ms  %6.1f ns each  %6.1f MB\n",
                     all, t, all > 0 ? 1e6 * (t - none) / all : 0.0,
                     (double)surface_index_bytes(x) / 1e6);
    }
    face_free(&face);
    surface_index_free(x);
    surface_work_free(w);
    return 0;
}
