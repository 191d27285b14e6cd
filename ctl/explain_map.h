/* explain_map.h -- the fields of an explanation as pictures' pixels. */
#ifndef CTL_EXPLAIN_MAP_H
#define CTL_EXPLAIN_MAP_H
#include <stdint.h>
#include "explain.h"

struct explain_map {   /* seen from the front */
    uint32_t w, h;     /* pixels; the first row is the lowest */
    double x_mm, y_mm; /* the middle of the first pixel, in the template's coordinates */
    double pixel_mm;
    uint8_t (
        *rgba[EXPLAIN_KINDS])[4]; /* [h * w] alpha 0 where the probe has no surface */
};

/* explain_map(x, out): the probe's surface where it lies on the template, once in the
 * colours of each field, lit from above so that the face can be seen.
 * out  released by explain_map_free(); empty on failure
 * Returns ST_OK, ST_ENOMEM. */
enum status explain_map(const struct explanation *x, struct explain_map *out);
void explain_map_free(struct explain_map *map); /* empty ones are allowed */

#endif
