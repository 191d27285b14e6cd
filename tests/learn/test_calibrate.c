/* The threshold and the table of rates learned from non-mated comparisons. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <cmocka.h>

#include "calibrate.h"
#include "calibration.h"
#include "rates.h"

#define SUBJECTS 100

/* A score for every ordered pair of subjects: -35 to 5, spread over the subjects, or
 * inconclusive for the given share. */
static struct rates *scores(uint32_t subjects, double inconclusive)
{
    static struct rates_score s[SUBJECTS * SUBJECTS];
    struct rates *r;
    size_t n = 0;

    for (uint32_t i = 0; i < subjects; i++)
        for (uint32_t k = 0; k < subjects; k++)
            if (i != k) {
                const double place = (double)((n * 7919) % 9901) / 9901;

                s[n].score =
                    place < inconclusive ? -(double)INFINITY : 5 - 40 * place * place;
                s[n].template = i;
                s[n++].probe = k;
            }
    assert_int_equal(rates_new(s, n, subjects, &r), ST_OK);
    return r;
}

static void test_learned(void **state)
{
    static const double wanted[] = {0.001, 0.0013, 0.01, 0.1, 0.5};
    struct rates *r = scores(SUBJECTS, 0);

    (void)state;
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        struct calibration d;
        bool knot = false;

        assert_int_equal(calibrate_learn(r, wanted[i], &d), ST_OK);
        assert_true(calibration_valid(&d));
        assert_true(rates_fmr(r, d.threshold) <= wanted[i]);
        assert_true(rates_fmr(r, d.threshold) > 0.9 * wanted[i]);
        assert_true(d.threshold == rates_at(r, wanted[i]));
        for (uint32_t k = 0; k < d.n; k++) {
            knot = knot || d.knot[k].score == d.threshold;
            assert_true(k == 0 || d.knot[k].rate == rates_fmr(r, d.knot[k].score));
        }
        assert_true(knot); /* the rate at the threshold is no interpolation */
        for (double at = -36; at < 6; at += 0.1) {
            assert_true(fabs(calibration_fmr(&d, at) - rates_fmr(r, at)) < 0.06);
            assert_true(calibration_fmr(&d, at) > 0);
        }
    }
    rates_free(r);
}

static void test_learned_from_little(void **state)
{
    struct calibration d;
    struct rates *r = scores(12, 0);

    (void)state;
    assert_int_equal(calibrate_learn(r, 0.001, &d), ST_ETOOFEW); /* 132 comparisons */
    assert_int_equal(calibrate_learn(r, 0.05, &d), ST_OK);
    assert_true(calibration_valid(&d));
    rates_free(r);
    r = scores(SUBJECTS, 0.4); /* 40 % are inconclusive */
    assert_int_equal(calibrate_learn(r, 0.01, &d), ST_OK);
    assert_true(d.knot[1].rate <= 0.6 && d.knot[0].rate == 1);
    rates_free(r);
    r = scores(SUBJECTS, 1);
    assert_int_equal(calibrate_learn(r, 0.01, &d), ST_ETOOFEW);
    rates_free(r);
    r = scores(2, 0);
    assert_int_equal(calibrate_learn(r, 0.5, &d), ST_ETOOFEW);
    rates_free(r);
}

static void test_subjects(void **state)
{
    (void)state;
    assert_int_equal(calibrate_subjects(0.001), 78);
    assert_int_equal(calibrate_subjects(0.0001), 246);
    assert_int_equal(calibrate_subjects(1), 3);
    for (double rate = 1; rate > 1e-9; rate /= 3) {
        const double n = calibrate_subjects(rate);

        assert_true(n * (n - 1) / 2 >= 3 / rate - 1e-5);
        assert_true((n - 1) * (n - 2) / 2 < 3 / rate);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_learned),
        cmocka_unit_test(test_learned_from_little),
        cmocka_unit_test(test_subjects),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
