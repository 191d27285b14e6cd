#include "verdict.h"

const char *verdict_decision(enum face_decision d)
{
    static const char *const name[] = {[FACE_MATCH] = "match",
                                       [FACE_NO_MATCH] = "no_match",
                                       [FACE_INCONCLUSIVE] = "inconclusive"};

    return name[d];
}

double verdict_fmr(const struct face_result *r, uint32_t n)
{
    double any = r->fmr_at_score;

    for (uint32_t i = 1; i < n; i++)
        any += (1 - any) * r->fmr_at_score;
    return any;
}
