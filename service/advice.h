/* advice.h -- what to change at the scanner, in plain words. Every refusal of a scan ends
 * with it; a check returns it beside notes, which need no change. */
#ifndef SERVICE_ADVICE_H
#define SERVICE_ADVICE_H
#include <stddef.h>
#include "libsurface.h"
#include "status.h"

#define ADVICE_LINES 8
#define ADVICE_NOTES 3
#define ADVICE_MAX   144

struct advice {
    size_t n;
    char line[ADVICE_LINES]
             [ADVICE_MAX]; /* "hold still and scan again: ...", no full stop */
    size_t nnote;
    char note[ADVICE_NOTES][ADVICE_MAX]; /* found in a scan that is accepted */
};

/* advice_give(st, found, face, out): what surface_build() found, and what to change; if
 * st is a refusal, first what concerns st. face: used if st is ST_OK.
 * Left and right are those of the person in front of the scanner. */
void advice_give(enum status st, const struct surface_found *found,
                 const struct surface_face *face, struct advice *out);

/* advice_round(v): Returns v, which is above 0, rounded to two digits. */
double advice_round(double v);

#endif
