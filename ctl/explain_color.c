#include "explain_color.h"

#include <math.h>

/* Stops of a scale: where, as a share of its end, and the colour. */
struct stop {
    double at;
    double rgb[3];
};

static const struct stop gap[] = {{-1, {24, 61, 145}},
                                  {-0.5, {90, 150, 214}},
                                  {0, {236, 236, 230}},
                                  {0.5, {233, 128, 90}},
                                  {1, {158, 16, 36}}};
static const struct stop part[] = {{-1, {90, 24, 110}},
                                   {-0.5, {168, 124, 190}},
                                   {0, {244, 244, 240}},
                                   {0.5, {122, 190, 120}},
                                   {1, {12, 90, 40}}};

void explain_color(enum explain_kind kind, double value, double end, uint8_t rgb[3])
{
    const struct stop *s = kind == EXPLAIN_PART ? part : gap;
    const double at = fmax(-1, fmin(1, value / end));
    double share;

    if (isnan(value)) {
        rgb[0] = rgb[1] = rgb[2] = EXPLAIN_COLOR_GREY;
        return;
    }
    while (s[1].at < at)
        s++;
    share = (at - s[0].at) / (s[1].at - s[0].at);
    for (int i = 0; i < 3; i++)
        rgb[i] = (uint8_t)lround(s[0].rgb[i] + share * (s[1].rgb[i] - s[0].rgb[i]));
}
