/* The decision's table is a distribution function, and the threshold is where its false match
 * rate is the one asked for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "decision.h"
#include "model.h"
#include "tuning.h"

static const struct decision *const d = &model_default.decision;

static void test_monotone(void **state)
{
    double last = 0;

    (void)state;
    for (int i = 0; i <= 50000; i++) {
        const double rate = decision_fmr(d, i * 1e-4);

        assert_true(rate > 0 && rate <= 1);
        assert_true(rate >= last);
        assert_true(rate < last + 0.001); /* and without jumps */
        last = rate;
    }
    assert_true(decision_fmr(d, 4) == 1 && decision_fmr(d, 1e300) == 1);
}

static void test_threshold(void **state)
{
    (void)state;
    assert_true(fabs(decision_fmr(d, d->threshold_mm) - 0.001) < 2e-4);
    assert_true(DECISION_MIN_OVERLAP > 0 && DECISION_MIN_OVERLAP < 0.5);
}

/* Noise raises the threshold: not that of ordinary scans, no further than it was measured, and
 * not where the pair is as smooth as ordinary scans are. */
static void test_noise(void **state)
{
    double last = 0;

    (void)state;
    for (int i = 0; i <= 150; i++) {
        const double noise = i * 0.02;
        const double rise =
            decision_terms(&(struct decision_pair){noise, 0.3, 0}).rise_mm;

        assert_true(noise > 0.55 ? rise > 0 : rise == 0);
        assert_true(rise >= last && rise < 0.041);
        assert_true(decision_terms(&(struct decision_pair){noise, 0.125, 0}).rise_mm ==
                    0);
        assert_true(decision_terms(&(struct decision_pair){noise, 0.14, 0}).rise_mm <
                    0.008);
        last = rise;
    }
    assert_true(last > 0.039);
}

/* The more is hidden, the lower the threshold and the wider the doubt; never is the doubt as
 * far as where most strangers are. */
static void test_hidden(void **state)
{
    struct decision_terms last = {1, 0, 0};

    (void)state;
    for (int i = 0; i <= 100; i++) {
        const struct decision_terms t =
            decision_terms(&(struct decision_pair){0, 0.3, i * 0.01});

        assert_true(t.rise_mm == 0);
        assert_true(t.factor <= last.factor && t.factor > 0.75);
        assert_true(t.doubt >= last.doubt && t.factor + t.doubt < 1.5);
        assert_true(i <= 5 ? t.factor == 1 && t.doubt == 0 : t.factor < 1 && t.doubt > 0);
        assert_true(last.factor - t.factor < 0.02 && t.doubt - last.doubt < 0.05);
        last = t;
    }
    assert_true(decision_fmr(d, last.factor * d->threshold_mm) < 1e-4);
}

static void test_odd_values(void **state)
{
    (void)state;
    assert_true(decision_fmr(d, -1) == decision_fmr(d, 0));
    assert_true(decision_fmr(d, 0) > 0 && decision_fmr(d, 0) < 1e-6);
    assert_true(decision_fmr(d, (double)NAN) == 1 &&
                decision_fmr(d, (double)INFINITY) == 1);
}

static void test_valid(void **state)
{
    struct decision bad = *d;

    (void)state;
    assert_true(decision_valid(d));
    bad.threshold_mm = (double)NAN;
    assert_false(decision_valid(&bad));
    bad = *d;
    bad.n = DECISION_KNOTS + 1;
    assert_false(decision_valid(&bad));
    bad = *d;
    bad.knot[3].mm = bad.knot[2].mm;
    assert_false(decision_valid(&bad));
    bad = *d;
    bad.n--; /* does not reach 1 */
    assert_false(decision_valid(&bad));
    bad = *d;
    bad.halving_mm = 0;
    assert_false(decision_valid(&bad));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_monotone),  cmocka_unit_test(test_valid),
        cmocka_unit_test(test_threshold), cmocka_unit_test(test_odd_values),
        cmocka_unit_test(test_noise),     cmocka_unit_test(test_hidden),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
