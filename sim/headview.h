/* headview.h -- what is seen of a head from +z, in parallel projection: a z-buffer over its
 * points, and the height of the surface between those that are seen. */
#ifndef SIM_HEADVIEW_H
#define SIM_HEADVIEW_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "head.h"
#include "surface.h"

struct headview {
    const struct head *head;        /* borrowed */
    uint8_t *seen;                  /* [head->n] */
    double x0, y0, x1, y1;          /* the box of all points */
    uint32_t nx, ny, *first, *item; /* squares of the view, and the points seen in each */
    struct headview_surface {       /* triangulated when first asked for */
        bool made;
        struct surface surface;
        uint32_t he;     /* where the last walk ended, */
        struct ivec2 at; /* at this place */
    } of[HEAD_VOID];     /* skin, cover */
};

/* headview_make(h, one_layer, v): one_layer: the skin has no surface behind another, as that of
 * a frontal crop, so that only what covers it hides it.  headview_free(v). */
void headview_make(const struct head *h, bool one_layer, struct headview *v);
void headview_free(struct headview *v);

/* headview_at(v, x, y, z): the front-most surface at (x, y): its height, interpolated between
 * the points seen; nothing is smoothed away.  Returns HEAD_SKIN or HEAD_COVER; or HEAD_VOID where
 * nothing is seen: z is NAN where there is something near by, else -INFINITY. */
enum head_part headview_at(struct headview *v, double x, double y, double *z);

#endif
