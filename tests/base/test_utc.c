/* link: -Wl,--wrap=clock_gettime */
/* Times: printed and read, for every day; texts that are no time; a clock out of range. */
#include <time.h>

#include "unit.h"
#include "utc.h"

#define DAY_MS INT64_C(86400000)

int __wrap_clock_gettime(clockid_t clock, struct timespec *out);

static struct timespec now;
static int rc;

int __wrap_clock_gettime(clockid_t clock, struct timespec *out)
{
    assert_int_equal(clock, CLOCK_REALTIME);
    *out = now;
    return rc;
}

/* Every day from 1970 to 9999, counted by the calendar's rules. */
TEST(test_days)
{
    static const int length[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    char text[UTC_TEXT], want[UTC_TEXT], day[32];
    int64_t ms = 12345678, back;

    for (int y = 1970; y <= 9999; y++)
        for (int m = 1; m <= 12; m++) {
            const int leap = y % 4 == 0 && (y % 100 != 0 || y % 400 == 0);

            for (int d = 1; d <= length[m - 1] + (leap && m == 2); d++) {
                (void)snprintf(day, sizeof day, "%04d-%02d-%02d", y, m, d);
                (void)snprintf(want, sizeof want, "%.10sT03:25:45.678Z", day);
                utc_print(ms, text);
                assert_string_equal(text, want);
                assert_true(utc_read(text, &back) && back == ms);
                assert_true(utc_read(day, &back) && back == ms - 12345678);
                ms += DAY_MS;
            }
        }
    assert_true(ms - 12345678 == INT64_C(253402300800000));
    utc_print(ms, text);
    assert_string_equal(text, "9999-12-31T23:59:59.999Z");
    utc_print(0, text);
    assert_string_equal(text, "1970-01-01T00:00:00.000Z");
}

TEST(test_read)
{
    static const struct {
        const char *text;
        int64_t ms;
    } good[] = {{"1970-01-01T00:00:00Z", 0},
                {"1970-01-01T01:00:00+01:00", 0},
                {"1969-12-31", -1},
                {"1970-01-01T00:00:01.5Z", 1500},
                {"1970-01-01T00:00:01.0019999Z", 1001},
                {"1970-01-01T00:00:00-23:59", 86340000},
                {"2027-01-31T14:30:00.5+01:30", INT64_C(1801400400500)},
                {"2027-01-31T14:30:00-00:30", INT64_C(1801407600000)},
                {"9999-12-31T23:59:59.999Z", INT64_C(253402300799999)}};
    static const char *const bad[] = {"",
                                      "2027",
                                      "2027-01-31T",
                                      "2027-01-31T14:30Z",
                                      "2027-01-31T14:30:00",
                                      "2027-01-31 14:30:00Z",
                                      "2027-01-31t14:30:00Z",
                                      "2027-01-31T14:30:00.Z",
                                      "2027-01-31T14:30:00z",
                                      "2027-01-31T24:00:00Z",
                                      "2027-01-31T23:60:00Z",
                                      "2027-01-31T23:59:60Z",
                                      "2027-01-31T14:30:00+1:00",
                                      "2027-01-31T14:30:00+24:00",
                                      "2027-01-31T14:30:00+00:60",
                                      "2027-01-31T14:30:00ZZ",
                                      "2027-02-29",
                                      "2100-02-29",
                                      "2027-00-10",
                                      "2027-13-10",
                                      "2027-01-00",
                                      "2027-04-31",
                                      "2027-1-1",
                                      "+027-01-01",
                                      "1970-01-01T00:30:00+01:00",
                                      "9999-12-31T23:59:59-00:01",
                                      "never"};
    int64_t ms;

    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_true(utc_read(good[i].text, &ms) == (good[i].ms >= 0));
        assert_true(good[i].ms < 0 || ms == good[i].ms);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (utc_read(bad[i], &ms))
            fail_msg("%s is read", bad[i]);
    assert_true(utc_read_end("1970-01-02", &ms) && ms == 2 * INT64_C(86400000) - 1);
    assert_true(utc_read_end("9999-12-31", &ms) && ms == INT64_C(253402300799999));
    assert_true(utc_read_end("1970-01-01T00:00:01Z", &ms) && ms == 1000);
    assert_false(utc_read_end("2027-02-29", &ms));
}

TEST(test_now)
{
    int64_t ms;

    now = (struct timespec){.tv_sec = 1800000000, .tv_nsec = 123999999};
    assert_true(utc_now(&ms) && ms == INT64_C(1800000000123));
    now.tv_sec = INT64_C(253402300799);
    assert_true(utc_now(&ms) && ms == INT64_C(253402300799123));
    now.tv_sec++;
    assert_true(!utc_now(&ms) && ms == 0);
    now.tv_sec = -1;
    assert_true(!utc_now(&ms) && ms == 0);
    now.tv_sec = 1;
    rc = -1;
    assert_true(!utc_now(&ms) && ms == 0);
    rc = 0;
}
