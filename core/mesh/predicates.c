#include "predicates.h"

#ifdef __FAST_MATH__
#error "core must not be compiled with -ffast-math: results would differ between machines"
#endif

/* Lowering the lift of one corner moves the plane through the lifted triangle below d (d
 * is then outside: not deeper than the plane) unless d itself is the one lowered.  Lowering
 * the corner p tilts the plane about the line through the other two corners: d sinks below
 * it or rises above it according to the side of that line on which d lies. */
bool incircle_tie(struct ivec2 a, struct ivec2 b, struct ivec2 c, struct ivec2 d)
{
    if (lex_less(d, a) && lex_less(d, b) && lex_less(d, c))
        return true;
    if (lex_less(a, b) && lex_less(a, c))
        return orient2d(b, c, d) < 0;
    if (lex_less(b, c))
        return orient2d(c, a, d) < 0;
    return orient2d(a, b, d) < 0;
}
