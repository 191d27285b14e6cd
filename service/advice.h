/* advice.h -- what to change at the scanner, in plain words: what every refusal of a scan
 * ends with, and what a check of one gives besides. */
#ifndef VERIFY_ADVICE_H
#define VERIFY_ADVICE_H
#include <stddef.h>
#include "status.h"

struct face;       /* face.h */
struct scan_found; /* scan.h */

#define ADVICE_LINES 8
#define ADVICE_MAX   144

struct advice {
    size_t n;
    char line[ADVICE_LINES]
             [ADVICE_MAX]; /* "hold still and scan again: ...", no full stop */
};

/* advice_give(st, found, face, out): what scan_build() left, and what to change; first what
 * st is about, where that is a refusal.  face: its quality counts where density_mm is not 0,
 * and its frame where st is ST_OK.
 * Left and right are those of the person in front of the scanner. */
void advice_give(enum status st, const struct scan_found *found, const struct face *face,
                 struct advice *out);

#endif
