/* The series give what the C library gives, to the last digits. */
#include <float.h>

#include "draw.h"
#include "series.h"
#include "unit.h"
#include "vec.h"

static struct draw rng = {7};

static void check_ln(double x)
{
    const double want = log(x), got = series_ln(x);

    if (!(fabs(got - want) <= 1e-15 * fabs(want)))
        fail_msg("ln %.17g: %.17g, wanted %.17g", x, got, want);
}

TEST(test_ln)
{
    assert_true(series_ln(1) == 0);
    for (int power = -1074; power < 1024; power++)
        for (int i = 0; i < 50; i++)
            check_ln(ldexp(1 + draw_uniform(&rng, 0, 1), power));
    for (int power = -52; power < 0; power++)
        for (int i = 0; i < 50; i++) { /* near 1, where its value is small */
            const double off = ldexp(1 + draw_uniform(&rng, 0, 1), power);

            check_ln(1 + off);
            check_ln(1 - off / 2);
        }
    check_ln(DBL_MAX);
    check_ln(DBL_MIN);
    check_ln(0.70710678118654746);
    check_ln(0.70710678118654757);
}

static void check_degrees(double y, double x)
{
    const double want = atan2(y, x) * VEC_DEGREES, got = series_degrees(y, x);

    if (!(fabs(got - want) <= 1e-13))
        fail_msg("(%.17g, %.17g): %.17g, wanted %.17g", x, y, got, want);
}

TEST(test_degrees)
{
    static const double edge[] = {0, DBL_TRUE_MIN, 1e-300, 0x1p-30, 1, 2, 1e300, DBL_MAX};
    const size_t n = sizeof edge / sizeof *edge;

    for (int i = 0; i < 1000000; i++)
        check_degrees(draw_uniform(&rng, -1, 1), draw_uniform(&rng, -1, 1));
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++)
            for (int s = 0; s < 4; s++)
                check_degrees(s & 1 ? 0.0 - edge[i] : edge[i],
                              s & 2 ? 0.0 - edge[k] : edge[k]);
    assert_true(series_degrees(0, 0) == 0 && series_degrees(1, 0) == 90 &&
                series_degrees(-1, 0) == -90 && series_degrees(0, -1) == 180);
    assert_true(isnan(series_degrees(NAN, 1)) && isnan(series_degrees(1, NAN)));
}
