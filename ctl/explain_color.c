#include "explain_color.h"

#include <math.h>

/* Stops of a scale: where, as a share of its end, and the colour. */
struct stop {
    double at;
    double rgb[3];
};

#define BAND (1 / EXPLAIN_TIMES) /* the threshold's place on its scale */

static const struct stop gap[] = {{-1, {24, 61, 145}},
                                  {-0.5, {90, 150, 214}},
                                  {0, {236, 236, 230}},
                                  {0.5, {233, 128, 90}},
                                  {1, {158, 16, 36}}};
static const struct stop rest[] = {{-1, {24, 61, 145}},      {-2 * BAND, {90, 150, 214}},
                                   {-BAND, {214, 228, 238}}, {0, {244, 244, 240}},
                                   {BAND, {246, 224, 212}},  {2 * BAND, {233, 128, 90}},
                                   {1, {158, 16, 36}}};
static const struct stop part[] = {{-1, {244, 244, 240}},
                                   {0, {244, 244, 240}},
                                   {BAND, {250, 214, 110}},
                                   {2 * BAND, {236, 120, 60}},
                                   {1, {140, 10, 40}}};

void explain_color(enum explain_kind kind, double value, double end, uint8_t rgb[3])
{
    const struct stop *s = kind == EXPLAIN_GAP ? gap : kind == EXPLAIN_REST ? rest : part;
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
