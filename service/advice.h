/* advice.h -- advice in plain words on changes at the scanner.  The text of every refusal of a scan ends
 * with it.  A check returns it beside notes, which need no change. */
#ifndef SERVICE_ADVICE_H
#define SERVICE_ADVICE_H
#include <stddef.h>
#include "libsurface.h"
#include "status.h"

#define ADVICE_LINES 8
#define ADVICE_NOTES 3
#define ADVICE_MAX   144 /* bytes of a line, with its NUL */

struct advice {
    size_t n; /* number of lines */
    /* Changes, "hold still and scan again: ...", without a full stop. */
    char line[ADVICE_LINES][ADVICE_MAX];
    size_t nnote;                        /* number of notes */
    char note[ADVICE_NOTES][ADVICE_MAX]; /* remarks on an accepted scan */
};

/* advice_give(st, found, face, out): Writes advice on the findings of surface_build().  If st is a refusal, the
 * first lines concern st.  Left and right are those of the person in front of the scanner.
 *   face  used only if st is ST_OK */
void advice_give(enum status st, const struct surface_found *found,
                 const struct surface_face *face, struct advice *out);

/* advice_round(v): Returns v, which is above 0, rounded to two digits. */
double advice_round(double v);

#endif
