/* When the scans of a door are said to have changed: examples, and simulated doors of which nothing changes, or the
 * noise doubles (docs/console.md, "Health"). */
#include "drift.h"
#include <math.h>
#include <stdlib.h>

#include "rates.h"
#include "unit.h"

#define TODAY INT64_C(20787) /* 2026-11-30, a Monday */
#define DAYS  STORE_SCAN_DAYS

static struct store_scans day[DAYS + 400];
static size_t n;

static void add(int64_t at, int64_t scans, double noise_mm, double quality,
                int64_t unusable)
{
    day[n++] = (struct store_scans){.day = at,
                                    .n = scans,
                                    .unusable = unusable,
                                    .noise_um = (int64_t)(noise_mm * 1000) * scans,
                                    .quality = (int64_t)(quality * 1000) * scans};
}

static void usual(int64_t days, int64_t until)
{
    n = 0;
    for (int64_t i = days; i > 0; i--)
        add(until - i, 40, 0.30 + 0.02 * (double)(i % 2), 0.9, 1);
}

static const char *said(int64_t today)
{
    static char out[DRIFT_TEXT];
    const struct drift d = drift_find(day, n, today);

    drift_say(&d, out);
    return out;
}

/* Two days of it, the second one today, after the usual ones. */
static void then(int64_t scans, double noise_mm, double quality, int64_t unusable)
{
    usual(60, TODAY - 1);
    add(TODAY - 1, scans, noise_mm, quality, unusable);
    add(TODAY, scans, noise_mm, quality, unusable);
}

TEST(test_words)
{
    then(40, 0.3, 0.9, 1);
    assert_string_equal(said(TODAY), "");
    then(40, 0.62, 0.9, 1);
    assert_string_equal(said(TODAY), "noise doubled since Sunday, 2026-11-29: "
                                     "0.62 mm, before 0.31 mm");
    assert_string_equal(said(TODAY + 6), "noise doubled since Sunday, 2026-11-29: "
                                         "0.62 mm, before 0.31 mm");
    assert_string_equal(said(TODAY + DRIFT_WINDOW), "");
    for (int64_t i = 1; i < 4; i++) /* it ends */
        add(TODAY + i, 40, 0.31, 0.9, 1);
    assert_string_equal(said(TODAY + 3), "");
    then(40, 0.5, 0.9, 1);
    assert_string_equal(said(TODAY), "noise rose by 61 % since Sunday, 2026-11-29: "
                                     "0.50 mm, before 0.31 mm");
    then(40, 1.2, 0.9, 1);
    assert_string_equal(said(TODAY), "noise is 4 times as high since Sunday, 2026-11-29: "
                                     "1.20 mm, before 0.31 mm");
    then(40, 0.15, 0.9, 1);
    assert_string_equal(said(TODAY), "noise halved since Sunday, 2026-11-29: "
                                     "0.15 mm, before 0.31 mm");
    then(40, 0.05, 0.9, 1);
    assert_string_equal(said(TODAY), "noise fell by 84 % since Sunday, 2026-11-29: "
                                     "0.05 mm, before 0.31 mm");
    then(40, 0.3, 0.7, 1);
    assert_string_equal(said(TODAY),
                        "quality fell since Sunday, 2026-11-29: 0.70, before 0.90");
    then(30, 0.9, 0.7, 10); /* what is refused comes first */
    assert_string_equal(said(TODAY), "more scans are unusable since Sunday, 2026-11-29: "
                                     "25 of 100, before 2 of 100");
    then(0, 0, 0, 40);
    assert_string_equal(said(TODAY), "more scans are unusable since Sunday, 2026-11-29: "
                                     "100 of 100, before 2 of 100");
}

/* Too few scans or days, before or since, too small a change, or a day that has not come. */
TEST(test_silent)
{
    then(DRIFT_SINCE / 2 - 1, 0.62, 0.9, 0);
    assert_string_equal(said(TODAY), "");
    usual(60, TODAY);
    add(TODAY, 40, 0.62, 0.9, 1); /* a single day */
    assert_string_equal(said(TODAY), "");
    usual(DRIFT_BEFORE_DAYS - 1, TODAY - 1);
    for (int64_t i = 0; i < 2; i++)
        add(TODAY - 1 + i, 40, 0.62, 0.9, 1);
    assert_string_equal(said(TODAY), "");
    then(40, 0.44, 0.78, 3);
    assert_string_equal(said(TODAY), "");
    then(40, 0.62, 0.5, 20);
    assert_string_equal(said(TODAY - 1), "");
    n = 0;
    for (int64_t i = 60; i >= 0; i--)
        add(TODAY - i, 0, 0, 0, 2);
    assert_string_equal(said(TODAY), "");
    n = 0;
    assert_string_equal(said(TODAY), "");
    day[n++] = (struct store_scans){.day = TODAY, .n = 1, .noise_um = INT64_MAX};
    assert_string_equal(said(TODAY), "");
}

/* ---- simulated doors */

static uint64_t seed;

static double uniform(void)
{
    return (rates_below(&seed, 1U << 30) + 0.5) / (1U << 30);
}

static double normal(void)
{
    return sqrt(-2 * log(uniform())) * cos(2 * 3.14159265358979 * uniform());
}

/* One standard deviation of what differs: scans by a factor of 1.5, days by 10 %, of which each resembles the one
 * before (correlation 0.8).  One scan in fifty is four times as noisy.  One in 33 is unusable, on some days twice as
 * many.  At the weekend there are a third of the scans. */
static double of_day;

static void live(int64_t at, double scans_a_day, double factor)
{
    const double bad = 0.03 * exp(0.5 * normal());
    const double busy =
        scans_a_day * exp(0.3 * normal()) * (at % 7 >= 2 && at % 7 < 4 ? 0.33 : 1);
    const int64_t scans = (int64_t)(busy + uniform());
    struct store_scans *d = &day[n++];

    of_day = 0.8 * of_day + 0.06 * normal();
    *d = (struct store_scans){.day = at};
    for (int64_t i = 0; i < scans; i++) {
        double mm = 0.3 * factor * exp(of_day + 0.4 * normal());

        if (uniform() < 0.02)
            mm *= 4;
        if (uniform() < bad || mm > 3) {
            d->unusable++;
            continue;
        }
        d->n++;
        d->noise_um += (int64_t)(1000 * mm);
        d->quality += (int64_t)(1000 * fmax(0, 1 - mm / 3));
    }
}

static const double SCANS[] = {3, 10, 40, 200};
#define KINDS 4
#define DOORS 100
#define YEAR  365

/* Counts the times that a door's change is said which was not said on the day before. */
static void cries(double scans_a_day, unsigned out[4])
{
    enum drift_of was = DRIFT_NONE;

    n = 0;
    for (int64_t i = 0; i < DAYS + YEAR; i++) {
        const size_t first = n > DAYS ? n - DAYS : 0;
        struct drift d;

        live(TODAY + i, scans_a_day, 1);
        d = drift_find(day + first, n - first, TODAY + i);
        out[d.of] += d.of != was;
        was = d.of;
    }
}

TEST(test_nothing_changes)
{
    seed = 1;
    for (int k = 0; k < KINDS; k++) {
        unsigned all[4] = {0};

        for (int i = 0; i < DOORS; i++)
            cries(SCANS[k], all);
        print_message(
            "%.0f scans a day, %d years of a door: said of noise %u, quality %u, "
            "unusable scans %u times\n",
            SCANS[k], DOORS, all[DRIFT_NOISE], all[DRIFT_QUALITY], all[DRIFT_UNUSABLE]);
        assert_in_range(all[DRIFT_NOISE] + all[DRIFT_QUALITY] + all[DRIFT_UNUSABLE], 0,
                        DOORS / 10);
    }
}

/* Returns the number of days until it is said, the first of them counted; 0: not within four weeks. */
static int seen(double scans_a_day, double factor, int64_t *since)
{
    n = 0;
    for (int64_t i = -56; i < 28; i++) {
        struct drift d;

        live(TODAY + i, scans_a_day, i < 0 ? 1 : factor);
        d = drift_find(day, n, TODAY + i);
        *since = d.since - TODAY;
        if (i >= 0 && d.of != DRIFT_NONE)
            return (int)i + 1;
    }
    return 0;
}

static int by_days(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* In the order of SCANS.  most: the days within which nine doors in ten are seen. */
static void assert_seen(double factor, const int most[KINDS], int right_least)
{
    int days[DOORS];

    for (int k = 0; k < KINDS; k++) {
        int never = 0, right = 0;

        for (int i = 0; i < DOORS; i++) {
            int64_t since;

            days[i] = seen(SCANS[k], factor, &since);
            right += days[i] > 0 && since >= -1 && since <= 1;
            never += days[i] == 0;
            days[i] = days[i] == 0 ? YEAR : days[i];
        }
        qsort(days, DOORS, sizeof *days, by_days);
        print_message(
            "noise times %.1f, %.0f scans a day: half of %d doors are seen on day %d, "
            "90 of 100 on day %d, %d not within four weeks; the day is right within "
            "one for %d\n",
            factor, SCANS[k], DOORS, days[DOORS / 2], days[DOORS * 9 / 10], never, right);
        assert_true(days[DOORS * 9 / 10] <= most[k]);
        assert_true(right >= right_least);
    }
}

TEST(test_doubled)
{
    seed = 2;
    assert_seen(2, (const int[KINDS]){28, 10, 4, 3}, 35);
    assert_seen(1.6, (const int[KINDS]){YEAR, YEAR, YEAR, YEAR}, 25);
}
