/* explain_color.h -- the colours of explain's pictures and cloud. */
#ifndef CTL_EXPLAIN_COLOR_H
#define CTL_EXPLAIN_COLOR_H
#include <stdint.h>
#include "explain.h"

#define EXPLAIN_COLOR_GREY 150 /* all three: no value */

/* explain_color(kind, value, end, rgb): full at explain_end().
 * gap, cell  blue behind the template, light where they meet, red in front of it
 * part       purple below 0, white at 0, green above
 * A value of NAN is grey. */
void explain_color(enum explain_kind kind, double value, double end, uint8_t rgb[3]);

#endif
