#include "headcamera.h"

#include <math.h>
#include <stdlib.h>

#include "draw.h"
#include "head.h"
#include "headspec.h"
#include "headview.h"

#define BASE    50.0  /* mm between the two cameras */
#define STEPS   16.0  /* of disparity to a pixel */
#define NOISE   0.04  /* of disparity, pixels */
#define LOST    0.005 /* share of the pixels without a value */
#define STEP_MM 12.0  /* more is an edge */
#define EDGE    6     /* pixels */
#define W       HEADCAMERA_WIDTH
#define H       HEADCAMERA_HEIGHT
#define FB      (HEADCAMERA_FOCAL * BASE)
#define TO_X(i) (((i) - (W - 1) / 2.0) / HEADCAMERA_FOCAL)
#define TO_Y(j) (((H - 1) / 2.0 - (j)) / HEADCAMERA_FOCAL)

/* The distance along the axis, mm, of each pixel: the head's, or the wall's. */
static void look(struct head *s, const struct headscan_options *o, struct draw *r,
                 double *depth)
{
    const double wall = o->distance + draw_uniform(r, 350, 1500);
    const double lean_x = draw_uniform(r, -0.3, 0.3), lean_y = draw_uniform(r, -0.1, 0.1);
    struct headview v;

    /* Perspective becomes a parallel view: each point moved across the axis to where its ray
     * meets the plane at o->distance. */
    for (size_t i = 0; i < s->n; i++) {
        struct dvec3 *p = &s->at[i];
        const double k = o->distance / (o->distance - p->z);

        *p = (struct dvec3){p->x * k, p->y * k, p->z};
    }
    headview_make(s, false, &v);
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            const double x = TO_X(i), y = TO_Y(j);
            double *d = &depth[j * W + i], z;

            (void)headview_at(&v, x * o->distance, y * o->distance, &z);
            *d = o->distance - z; /* NAN: nothing comes back */
            if (isinf(z))
                *d = wall / (1 + lean_x * x + lean_y * y);
        }
    headview_free(&v);
}

/* At a step in depth, EDGE pixels wide at most: the far side's pixels beside it lie in the
 * shadow of the second camera, or mix both sides. */
static void smear(struct draw *r, const double *depth, double *out)
{
    for (int k = 0; k < W * H; k++)
        out[k] = depth[k];
    for (int j = 0; j < H; j++)
        for (int i = 1, last = 0; i < W; i++) {
            const double a = depth[j * W + last], b = depth[j * W + i];
            const int from = last;

            if (isnan(b))
                continue;
            last = i;
            if (!(fabs(a - b) >= STEP_MM) || i - from > EDGE)
                continue;
            /* Where the near side is on the left its shadow lies to the right. */
            for (int k = i; b > a && k < W && k < i + FB / a - FB / b; k++) {
                if (depth[j * W + k] < b - STEP_MM)
                    break;
                out[j * W + k] = (double)NAN;
            }
            if (draw_uniform(r, 0, 1) < 0.5)
                out[j * W + (b > a ? from + 1 : i - 1)] =
                    a + draw_uniform(r, 0.1, 0.9) * (b - a);
        }
}

void headcamera_see(struct head *s, const struct headscan_options *o,
                    struct headscan *out)
{
    struct draw r = draw_stream(o->seed, 0, 4);
    double *clean = head_alloc((size_t)W * H, sizeof *clean);
    double *depth = head_alloc((size_t)W * H, sizeof *depth);

    look(s, o, &r, clean);
    smear(&r, clean, depth);
    out->n = (size_t)W * H;
    out->width = W;
    out->height = H;
    out->at = head_alloc(out->n, sizeof *out->at);
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            const double disparity = FB / depth[j * W + i] + NOISE * draw_normal(&r);
            const double d = FB * STEPS / nearbyint(disparity * STEPS);
            struct dvec3 *p = &out->at[j * W + i];

            *p = (struct dvec3){TO_X(i) * d, TO_Y(j) * d, -d};
            if (draw_uniform(&r, 0, 1) < LOST)
                *p = (struct dvec3){(double)NAN, (double)NAN, (double)NAN};
        }
    free(clean);
    free(depth);
}
