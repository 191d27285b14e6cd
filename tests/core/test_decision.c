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
        struct decision_pair p = {.score_mm = 0.5,
                                  .part_mm = (double)INFINITY,
                                  .noise_mm = noise,
                                  .rough_mm = 0.3};
        const double rise = decision_terms(0.1, &p).threshold_mm - 0.1;

        assert_true(noise > 0.55 ? rise > 0 : rise == 0);
        assert_true(rise >= last && rise < 0.041);
        assert_true(fabs(decision_terms(0.1, &p).calibrated_mm - (0.5 - rise)) < 1e-12);
        p.rough_mm = 0.125;
        assert_true(decision_terms(0.1, &p).threshold_mm == 0.1);
        p.rough_mm = 0.14;
        assert_true(decision_terms(0.1, &p).threshold_mm < 0.108);
        last = rise;
    }
    assert_true(last > 0.039);
}

/* The more is hidden, the lower the threshold and the wider the doubt; never is the doubt as
 * far as where most strangers are. */
static void test_hidden(void **state)
{
    struct decision_terms last = {.threshold_mm = 1};

    (void)state;
    for (int i = 0; i <= 100; i++) {
        const struct decision_pair p = {.score_mm = 2, .hidden = i * 0.01};
        const struct decision_terms t = decision_terms(1, &p);

        if (i > 5) { /* then no part raises it */
            assert_true(t.threshold_mm < 1 && t.doubt_mm > 0);
            assert_true(t.threshold_mm <= last.threshold_mm && t.threshold_mm > 0.75);
            assert_true(t.threshold_mm + t.doubt_mm < 1.5);
            assert_true(last.threshold_mm - t.threshold_mm < 0.02);
            assert_true(t.doubt_mm - last.doubt_mm < 0.05 && t.doubt_mm >= last.doubt_mm);
            assert_true(fabs(t.calibrated_mm * t.threshold_mm - 2) < 1e-12);
            last = t;
        } else {
            assert_true(t.doubt_mm == 0);
        }
    }
    assert_true(decision_fmr(d, last.threshold_mm * d->threshold_mm) < 1e-4);
}

/* A part of the face that fits well makes a match of a score above the threshold, but not far;
 * of no other, and not where anything is hidden.  A higher score never has a lower calibrated
 * one. */
static void test_part(void **state)
{
    double before = 0;

    (void)state;
    for (int i = 0; i <= 300; i++) {
        struct decision_pair p = {.score_mm = i * 0.01, .part_mm = 0.6};
        struct decision_terms t = decision_terms(1, &p);
        const bool open = decision_open(1, &p);

        assert_true(open == (i > 100 && i <= 150));
        assert_true(t.threshold_mm == (open ? 1.5 : 1));
        assert_true((p.score_mm <= t.threshold_mm) == (i <= 150));
        assert_true((p.score_mm <= t.threshold_mm) == (t.calibrated_mm <= 1));
        assert_true(t.calibrated_mm >= before && t.calibrated_mm <= p.score_mm);
        before = t.calibrated_mm;
        p.part_mm = 0.78;
        assert_true(decision_terms(1, &p).threshold_mm == 1);
        p.part_mm = 0.6;
        p.hidden = 0.06;
        assert_true(!decision_open(1, &p) && decision_terms(1, &p).threshold_mm < 1);
    }
}

/* Noise that raises the threshold raises it for a part as well. */
static void test_part_noise(void **state)
{
    struct decision_pair p = {
        .score_mm = 0.15, .part_mm = 0.08, .noise_mm = 0.75, .rough_mm = 0.3};

    (void)state;
    assert_true(decision_open(0.1, &p) && decision_terms(0.1, &p).calibrated_mm == 0.1);
    p.part_mm = 0.1;
    assert_true(decision_terms(0.1, &p).calibrated_mm > 0.13);
    p.part_mm = 0.08;
    p.noise_mm = 0.5;
    assert_true(decision_terms(0.1, &p).calibrated_mm == 0.15);
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
        cmocka_unit_test(test_part),      cmocka_unit_test(test_part_noise),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
