#include "model.h"

/* Quantiles of 16,136 comparisons of different people, close relatives left out
 * (docs/decision.md). */
const struct model model_default = {
    .decision =
        {
            .threshold_mm = 0.71,
            .halving_mm = 0.05,
            .n = 13,
            .knot = {{0.6788, 0.0005},
                     {0.7151, 0.001},
                     {0.7383, 0.002},
                     {0.7881, 0.005},
                     {0.8474, 0.01},
                     {0.9267, 0.02},
                     {1.0499, 0.05},
                     {1.1731, 0.1},
                     {1.3391, 0.2},
                     {1.7431, 0.5},
                     {2.2846, 0.8},
                     {3.0013, 0.95},
                     {4.0, 1.0}},
        },
};
