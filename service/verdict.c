#include "verdict.h"

const char *verdict_decision(enum face_decision d)
{
    static const char *const name[] = {[FACE_MATCH] = "match",
                                       [FACE_NO_MATCH] = "no_match",
                                       [FACE_INCONCLUSIVE] = "inconclusive"};

    return name[d];
}
