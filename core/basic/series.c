#include "series.h"

#include <float.h>
#include <math.h>

#include "vec.h"

_Static_assert(FLT_EVAL_METHOD == 0,
               "a float is computed as a float, a double as a double");

double series_ln(double x)
{
    static const double ln2 = 0.693147180559945309;
    int power;
    double m = frexp(x, &power), t, tt, sum = 0;

    if (m < 0.70710678118654752) {
        m *= 2;
        power--;
    }
    /* ln m = 2 artanh t, |t| < 0.172: the 13th term is below 1e-20. */
    t = (m - 1) / (m + 1);
    tt = t * t;
    for (int k = 25; k >= 1; k -= 2)
        sum = sum * tt + 1.0 / k;
    return power * ln2 + 2 * t * sum;
}

double series_degrees(double y, double x)
{
    const double a = fabs(y), b = fabs(x), long_side = a > b ? a : b;
    double t = long_side == 0 ? 0 : (a > b ? b : a) / long_side, tt, sum = 0, angle;

    for (int i = 0; i < 2; i++) /* tan of the half angle */
        t /= 1 + sqrt(1 + t * t);
    /* artan t, t < 0.199: the 12th term is below 1e-17. */
    tt = t * t;
    for (int k = 23; k >= 1; k -= 2)
        sum = 1.0 / k - sum * tt;
    angle = 4 * t * sum * VEC_DEGREES;
    if (a > b)
        angle = 90 - angle;
    if (x < 0)
        angle = 180 - angle;
    return y < 0 ? -angle : angle;
}
