/* headview.h -- the visible surface of a head from +z, in parallel projection: a z-buffer over its
 * points, and heights between the visible points. */
#ifndef SIM_HEADVIEW_H
#define SIM_HEADVIEW_H
#include <stdbool.h>
#include <stdint.h>
#include "head.h"
#include "surface.h"

struct headview {
    const struct head *head;        /* borrowed */
    uint8_t *seen;                  /* [head->n] */
    double x0, y0, x1, y1;          /* the box of all points */
    uint32_t nx, ny, *first, *item; /* squares of the view, and the points seen in each */
    struct headview_surface {       /* triangulated at the first use */
        bool made;
        struct surface surface;
        uint32_t he;     /* half-edge at the end of the last walk */
        struct ivec2 at; /* point at the end of the last walk */
    } of[HEAD_VOID];     /* skin, cover */
};

/* headview_make(h, one_layer, v): Finds the visible points of h.
 *   one_layer  the skin has one layer, as in a frontal crop: only a cover hides it
 *   v          to be released by headview_free() */
void headview_make(const struct head *h, bool one_layer, struct headview *v);
void headview_free(struct headview *v);

/* headview_at(v, x, y, z): Sets *z to the height of the front-most surface at (x, y), interpolated
 * between visible points without smoothing.  Returns HEAD_SKIN or HEAD_COVER; HEAD_VOID if nothing
 * is visible there: then *z is NAN if a point is near, else -INFINITY. */
enum head_part headview_at(struct headview *v, double x, double y, double *z);

#endif
