/* A calibration is a distribution function of non-mated scores, and says no more than it knows. */
#include "libsurface.h"
#include "model.h"
#include "unit.h"

static const struct surface_calibration table = {
    8, 4, {{-50, 1}, {-10, 0.5}, {0, 0.1}, {10, 0.001}}, {0, 0, 0}};

TEST(test_by_hand)
{
    assert_true(surface_calibration_rate(&table, -50.001) == 1 &&
                surface_calibration_rate(&table, -50) == 1);
    assert_true(surface_calibration_rate(&table, -30) == 0.75);
    assert_true(surface_calibration_rate(&table, -10) == 0.5);
    assert_true(fabs(surface_calibration_rate(&table, -2.5) - 0.2) < 1e-12);
    assert_true(surface_calibration_rate(&table, 0) == 0.1);
    assert_true(surface_calibration_rate(&table, 10) == 0.001); /* and no better beyond */
    assert_true(surface_calibration_rate(&table, 10.001) == 0.001);
}

/* The shipped one too: monotone, without jumps, and the wanted rate at its threshold. */
TEST(test_shipped)
{
    const struct surface_calibration *c = &model_default.calibration;
    double last = surface_calibration_rate(c, -200);

    assert_true(surface_calibration_valid(c));
    for (int i = 0; i <= 50000; i++) {
        const double rate = surface_calibration_rate(c, -200 + i * 0.01);

        assert_true(rate > 0 && rate <= last && rate > last - 0.01);
        last = rate;
    }
    assert_true(surface_calibration_rate(c, c->threshold) < 1e-3);
}

TEST(test_odd_values)
{
    assert_true(surface_calibration_rate(&table, (double)NAN) == 1);
    assert_true(surface_calibration_rate(&table, -(double)INFINITY) == 1);
    assert_true(surface_calibration_rate(&table, (double)INFINITY) == 0.001);
}

/* ---- identification */

/* A law with round numbers: 0.0005 at 10, a tenth of it each 5. */
static const struct surface_calibration with_law = {
    8, 4, {{-50, 1}, {-10, 0.5}, {0, 0.1}, {10, 0.001}}, {0.0005, 5, 1000}};

static double fpir(const struct surface_calibration *c, uint32_t people, double score)
{
    return surface_search_fpir(c, people, score, NULL);
}

static bool near(double x, double y)
{
    return fabs(x - y) <= 1e-12 * fabs(y);
}

TEST(test_fpir_by_hand)
{
    int extrapolated = 7;

    assert_true(fpir(&table, 0, 0) == 0);
    assert_true(near(fpir(&table, 1, 0), 0.1));
    assert_true(near(fpir(&table, 2, 0), 0.19));
    assert_true(near(fpir(&table, 3, 0), 0.271));
    assert_true(near(fpir(&table, 2, -30), 0.9375));
    assert_true(fpir(&table, 5, -60) == 1);
    assert_true(fpir(&table, 5, (double)NAN) == 1);
    assert_true(near(fpir(&table, 2, 10), 0.001999)); /* without a law no less beyond */
    assert_true(near(surface_search_fpir(&table, 2, 99, &extrapolated), 0.001999));
    assert_int_equal(extrapolated, 0);

    assert_true(near(surface_search_fpir(&with_law, 2, 0, &extrapolated), 0.19));
    assert_int_equal(extrapolated, 0);
    assert_true(near(surface_search_fpir(&with_law, 1, 10, &extrapolated), 0.0005));
    assert_int_equal(extrapolated, 1);
    assert_true(near(fpir(&with_law, 1, 15), 0.00005));
    assert_true(near(fpir(&with_law, 1, 60), 5e-14));
    assert_true(near(fpir(&with_law, 2, 15), 1e-4 - 25e-10));
    assert_true(fpir(&with_law, UINT32_MAX, 9999) == 0);
    assert_true(fpir(&with_law, 5, (double)INFINITY) == 0);
    /* Beyond its people the law decides nothing, but it still says. */
    assert_true(fpir(&with_law, 100000, 20) < 0.4);
}

/* Against the C library, over the range of sizes and scores. */
TEST(test_fpir_as_libm)
{
    for (uint32_t n = 1; n < 2000000000; n = 2 * n + 1)
        for (double score = -12; score < 300; score += 0.57) {
            const double rate = score >= 10 ? 0.0005 * pow(10, -(score - 10) / 5)
                                            : surface_calibration_rate(&table, score);
            const double want = -expm1(n * log1p(-rate));

            assert_true(fabs(fpir(&with_law, n, score) - want) <= 1e-10 * want);
        }
}

/* The least score of a match is that of a verification while the gallery is small, then on the knots, then
 * on the law, then none. */
TEST(test_threshold_by_hand)
{
    struct surface_calibration strict = with_law;

    assert_true(surface_search_threshold(&table, 0) == 8);
    assert_true(surface_search_threshold(&with_law, 1) == 9.091); /* 2.08 % at 8 */
    strict.threshold = 10.25;
    assert_true(surface_search_threshold(&strict, 0) == 10.25);
    assert_true(surface_search_threshold(&strict, 1) == 10.25);
    assert_true(surface_search_threshold(&strict, 20) == 10.25);
    strict.threshold = 10.2503; /* not rounded where it decides */
    assert_true(surface_search_threshold(&strict, 20) == 10.2503);
    strict.threshold = 9.0905; /* the next thousandth */
    assert_true(surface_search_threshold(&strict, 1) == 9.091);
    /* 0.0005 10^-(s / 5) = 1 - 0.99^(1/1000) = 1.00503e-5: s = 8.484 */
    assert_true(surface_search_threshold(&strict, 1000) == 18.484);
    assert_true(isinf(surface_search_threshold(&strict, 1001)));
    /* without a law 0.001 supports ten people: 1 - 0.999^10 = 0.00996 */
    assert_true(surface_search_threshold(&table, 10) == 10);
    assert_true(isinf(surface_search_threshold(&table, 11)));
}

/* The threshold is the least of all thousandths that keeps the rate, and rises with the gallery. */
static void check_threshold(const struct surface_calibration *c, uint32_t people)
{
    const double t = surface_search_threshold(c, people);
    double least = c->threshold;

    if (fpir(c, people, least) > SURFACE_FPIR)
        for (int64_t k = (int64_t)floor(least * 1000);
             fpir(c, people, least = (double)k / 1000) > SURFACE_FPIR; k++)
            ;
    assert_true(t == least);
}

TEST(test_threshold_by_search)
{
    double last = -(double)INFINITY;

    for (uint32_t n = 0; n <= model_default.calibration.tail.people; n += 1 + n / 7) {
        const double t = surface_search_threshold(&model_default.calibration, n);

        assert_true(t >= last && t >= model_default.calibration.threshold);
        assert_true(fpir(&model_default.calibration, n, t) <= SURFACE_FPIR);
        check_threshold(&model_default.calibration, n);
        last = t;
    }
    for (uint32_t n = 0; n <= with_law.tail.people; n += 1 + n / 7)
        check_threshold(&with_law, n);
    for (uint32_t n = 0; n <= 10; n++)
        check_threshold(&table, n);
}

/* Of the shipped table: one person is a verification, and beyond its law's people nobody matches. */
TEST(test_threshold_shipped)
{
    const struct surface_calibration *c = &model_default.calibration;

    assert_true(surface_search_threshold(c, 1) == c->threshold);
    assert_int_equal(c->tail.people, 10000);
    assert_true(isfinite(surface_search_threshold(c, 10000)));
    assert_true(isinf(surface_search_threshold(c, 10001)));
    assert_true(isinf(surface_search_threshold(c, 100000)));
}

/* The largest gallery is the last with a threshold. */
static void check_people(const struct surface_calibration *c, uint32_t want)
{
    assert_int_equal(surface_search_people(c), want);
    assert_true(isfinite(surface_search_threshold(c, want)));
    assert_true(want == UINT32_MAX || isinf(surface_search_threshold(c, want + 1)));
}

TEST(test_people)
{
    struct surface_calibration c = table;

    check_people(&table, 10);
    check_people(&with_law, 1000);
    check_people(&model_default.calibration, 10000);
    c.knot[3].rate = 0.02; /* not even one person */
    check_people(&c, 0);
    c.knot[3].rate = 1e-300;
    check_people(&c, UINT32_MAX);
    c = with_law;
    c.tail.people = 3; /* the knots support more than the law is for */
    check_people(&c, 10);
}

TEST(test_valid)
{
    struct surface_calibration c = table;

    assert_true(surface_calibration_valid(&c));
    c.threshold = -8;
    assert_true(surface_calibration_valid(&c));
    c.threshold = (double)NAN;
    assert_false(surface_calibration_valid(&c));
    c.threshold = 1e4;
    assert_false(surface_calibration_valid(&c));
    c = table;
    c.n = SURFACE_KNOTS + 1;
    assert_false(surface_calibration_valid(&c));
    c.n = 1;
    assert_false(surface_calibration_valid(&c));
    c = table;
    c.knot[2].score = c.knot[1].score;
    assert_false(surface_calibration_valid(&c));
    c = table;
    c.knot[2].rate = c.knot[1].rate;
    assert_false(surface_calibration_valid(&c));
    c = table;
    c.knot[0].rate = 0.99; /* not all */
    assert_false(surface_calibration_valid(&c));
    c = table;
    c.knot[3].rate = 0; /* nobody can know that */
    assert_false(surface_calibration_valid(&c));
    c = table;
    c.knot[3].score = (double)INFINITY;
    assert_false(surface_calibration_valid(&c));
}

TEST(test_valid_law)
{
    struct surface_calibration c = with_law;

    assert_true(surface_calibration_valid(&c));
    c.tail.rate = 0.001; /* that of the last knot */
    assert_true(surface_calibration_valid(&c));
    c.tail.rate = 0.0011; /* rates would rise */
    assert_false(surface_calibration_valid(&c));
    c.tail.people = 0; /* no law: its numbers do not count */
    assert_true(surface_calibration_valid(&c));
    c = with_law;
    c.tail.rate = 0;
    assert_false(surface_calibration_valid(&c));
    c = with_law;
    c.tail.decade = 0;
    assert_false(surface_calibration_valid(&c));
    c.tail.decade = (double)NAN;
    assert_false(surface_calibration_valid(&c));
    c.tail.decade = 1e4;
    assert_false(surface_calibration_valid(&c));
}

/* A table of few pairs: its own rates to its last knot, then as fast as the other's. */
TEST(test_continue)
{
    struct surface_calibration c = {8, 2, {{-10, 1}, {9, 0.02}}, {.people = 0}};
    const struct surface_calibration by = {
        8, 2, {{-10, 1}, {7, 0.001}}, {0.001, 5, 10000}};
    int extrapolated;

    assert_true(isinf(surface_search_threshold(&c, 100)));
    surface_calibration_continue(&c, &by);
    assert_int_equal(surface_calibration_valid(&c), 1);
    assert_int_equal(surface_search_people(&c), 10000);
    /* 0.02 falls tenfold to 0.002 at 14, where 5 people have an FPIR of 1 %. */
    assert_true(fabs(surface_search_fpir(&c, 1, 14, &extrapolated) - 0.002) < 1e-12);
    assert_int_equal(extrapolated, 1);
    assert_true(fabs(surface_search_threshold(&c, 5) - 14) < 0.01);
    assert_true(surface_calibration_rate(&c, 14) ==
                0.02); /* verifications do not extrapolate */
}
