/* The error trade-off: its points against the rates themselves, how many people it takes, and what is no DET. */
#include <math.h>
#include <string.h>

#include "det.h"
#include "unit.h"

#define MOST 64
#define SEED 3

/* Each person has one probe against every other's template, and `mated` of them two against their own. */
static struct rates *make(uint32_t people, uint32_t mated)
{
    static struct rates_score s[MOST * (MOST + 1)];
    struct rates *r;
    uint64_t seed = SEED;
    size_t n = 0;

    for (uint32_t a = 0; a < people; a++)
        for (uint32_t b = 0; b < people; b++)
            if (a != b)
                s[n++] = (struct rates_score){-(double)rates_below(&seed, 1000), a, b};
    for (uint32_t a = 0; a < mated; a++)
        for (int twice = 0; twice < 2; twice++)
            s[n++] = (struct rates_score){(double)rates_below(&seed, 500) - 100, a, a};
    assert_int_equal(rates_new(s, n, people, &r), ST_OK);
    return r;
}

TEST(test_points)
{
    struct rates *r = make(MOST, 40);
    struct det d;

    assert_int_equal(det_learn(r, MOST * (MOST - 1) / 2, 0, -50, SEED, &d), ST_OK);
    assert_true(det_valid(&d));
    assert_int_equal(d.people, 40);
    assert_int_equal(d.n, 8); /* 0.5 to 0.002: 2016 pairs support 0.0015 */
    for (uint32_t i = 0; i < d.n; i++) {
        const struct det_point *p = &d.point[i];

        assert_true(p->score == rates_at(r, p->fmr));
        assert_true(p->fnmr == rates_fnmr(r, p->score));
        assert_true(p->low <= p->fnmr && p->fnmr <= p->high && p->high >= 3.0 / 40);
    }
    assert_true(d.own.fnmr == rates_fnmr(r, 0) && d.own.fmr == rates_fmr(r, 0));
    assert_true(d.shipped.fnmr == rates_fnmr(r, -50) && d.shipped.score == -50);
    assert_true(d.own.fnmr > 0.1 && d.own.low > 0 && d.own.high < 0.5);
    rates_free(r);
}

TEST(test_few)
{
    struct rates *r = make(MOST, DET_PEOPLE - 1);
    struct det d;

    assert_int_equal(det_learn(r, 2016, 0, 0, SEED, &d), ST_OK);
    assert_true(det_valid(&d) && d.n == 0 && d.people == DET_PEOPLE - 1);
    rates_free(r);
    r = make(DET_PEOPLE, DET_PEOPLE);
    assert_int_equal(det_learn(r, 435, 0, 0, SEED, &d), ST_OK);
    assert_true(det_valid(&d) && d.n == 6); /* 0.01: 435 pairs support 0.007 */
    rates_free(r);
}

TEST(test_invalid)
{
    struct rates *r = make(MOST, 40);
    struct det good, d;

    assert_int_equal(det_learn(r, 2016, 0, 0, SEED, &good), ST_OK);
    rates_free(r);
#define WRONG(change)                                                                    \
    d = good;                                                                            \
    change;                                                                              \
    assert_false(det_valid(&d))
    WRONG(d.n = DET_POINTS + 1);
    WRONG(d.people = DET_PEOPLE - 1);
    WRONG(d.own.fnmr = d.own.high + 0.01);
    WRONG(d.shipped.low = -0.1);
    WRONG(d.own.score = NAN);
    WRONG(d.point[1].fmr = d.point[0].fmr);
    WRONG(d.point[2].score = d.point[1].score - 1);
    WRONG(d.point[d.n - 1].fnmr = NAN);
    WRONG(d.point[d.n - 1].high = 1.1);
}
