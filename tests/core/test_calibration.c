/* A calibration is a distribution function of non-mated scores, and says no more than it knows. */
#include "libsurface.h"
#include "model.h"
#include "unit.h"

static const struct surface_calibration table = {
    8, 4, {{-50, 1}, {-10, 0.5}, {0, 0.1}, {10, 0.001}}};

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
