/* The decision's table: a distribution function, and the threshold where it says. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "decision.h"

static void test_monotone(void **state)
{
    double last = 0;

    (void)state;
    for (int i = 0; i <= 50000; i++) {
        const double rate = decision_fmr(i * 1e-4);

        assert_true(rate > 0 && rate <= 1);
        assert_true(rate >= last);
        assert_true(rate < last + 0.001); /* and without jumps */
        last = rate;
    }
    assert_true(decision_fmr(4) == 1 && decision_fmr(1e300) == 1);
}

static void test_threshold(void **state)
{
    (void)state;
    assert_true(fabs(decision_fmr(decision_threshold_mm) - 0.001) < 2e-4);
    assert_true(decision_min_overlap > 0 && decision_min_overlap < 0.5);
}

static void test_odd_values(void **state)
{
    (void)state;
    assert_true(decision_fmr(-1) == decision_fmr(0));
    assert_true(decision_fmr(0) > 0 && decision_fmr(0) < 1e-6);
    assert_true(decision_fmr((double)NAN) == 1 && decision_fmr((double)INFINITY) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_monotone),
        cmocka_unit_test(test_threshold),
        cmocka_unit_test(test_odd_values),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
