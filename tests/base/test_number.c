/* number_read() against strtod(). */
#include <inttypes.h>

#include "number.h"
#include "unit.h"

static uint64_t next_random(uint64_t *x) /* splitmix64 */
{
    uint64_t z = *x += UINT64_C(0x9E3779B97F4A7C15);

    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static void check(const char *text)
{
    const double want = strtod(text, NULL);
    double got = NAN;
    const char *end = number_read(text, text + strlen(text), &got);

    if (end != text + strlen(text) || memcmp(&want, &got, sizeof want) != 0)
        fail_msg("%.60s: %.17g, not %.17g", text, got, want);
}

TEST(test_known)
{
    char texts[] =
        "0 -0 +1 1. .5 -.5e1 1e22 1e23 123456789012345678 9007199254740993 9007199254740992 "
        "9007199254740993.0 1e-22 1e-23 0.1 0.30000000000000004 2.2250738585072011e-308 "
        "4.9e-324 2.4e-324 2.5e-324 1.7976931348623157e308 1.7976931348623159e308 1e400 "
        "1e-400 0.000000000000000000000000000000000000000000000001e48 "
        "0e99999999999999999999 1e99999999999999999999 1e-99999999999999999999 "
        "00000000000000000000001.50 8.5e15 179769313486231580793728971405301e276 "
        /* half way between doubles */
        "4503599627370496.5 4503599627370497.5 -2251799813685248.25 2251799813685248.75 "
        "1125899906842624.125 1125899906842624.375 1125899906842624.376 "
        /* just below, just above half way from 1 */
        "1.0000000000000001110 1.000000000000000112 "
        "9999999999999999999 0.9999999999999999999 9.999999999999999999 "
        "18446744073709551615 1844674407370955161.5 0.0000000000000000001 "
        "9007199254740993e-19 9007199254740993e-20 1000000000000000000000000";

    for (char *t = strtok(texts, " "); t != NULL; t = strtok(NULL, " "))
        check(t);
}

/* Half way between two doubles, then a digit far behind that decides; the longest number. */
TEST(test_half_way)
{
    char text[NUMBER_MAX + 8] = "1.00000000000000011102230246251565404236316680908203125";
    const size_t len = strlen(text);
    double value;

    check(text); /* exactly half: to even */
    memset(text + len, '0', NUMBER_MAX - len);
    check(text);
    text[NUMBER_MAX - 1] = '1';
    check(text);
    memset(text, '9', NUMBER_MAX);
    check(text);
    strcpy(text + NUMBER_MAX - 6, "e-1600");
    check(text);
    strcat(text, "0");
    assert_null(number_read(text, text + strlen(text), &value));
}

TEST(test_random)
{
    uint64_t seed = 20;
    char text[64];

    print_message("seed 20\n");
    for (int i = 0; i < 200000; i++) {
        const uint64_t bits = next_random(&seed);
        double value;

        memcpy(&value, &bits, sizeof value);
        if (isfinite(value)) {
            (void)snprintf(text, sizeof text, "%.*g", (int)(bits % 19) + 1, value);
            check(text);
        }
        value = (double)(int64_t)bits / 1e16;
        (void)snprintf(text, sizeof text, "%.*f", (int)(bits % 9), value);
        check(text);
        (void)snprintf(text, sizeof text, "%.*f", (int)(bits % 19), value);
        check(text);
        (void)snprintf(text, sizeof text, "%.17g", (double)(float)value);
        check(text);
        (void)snprintf(text, sizeof text, "%" PRIu64 "e-%d",
                       bits % UINT64_C(10000000000000000000), (int)(bits % 20));
        check(text);
    }
}

TEST(test_no_number)
{
    static const char *const texts[] = {"",    "+",   "-",   ".",  "-.",  "e5",
                                        "nan", "inf", "--1", "x1", "+e1", " 1"};
    double value;

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_null(number_read(texts[i], texts[i] + strlen(texts[i]), &value));
}

/* A number ends at the first byte that does not continue it; nothing past `end` is read. */
TEST(test_ends)
{
    static const char text[] = "12.5e+7", comma[] = "1,5", hex[] = "0x10";
    static const struct {
        size_t given, taken;
        double value;
    } rows[] = {{1, 1, 1},    {2, 2, 12},   {3, 3, 12},    {4, 4, 12.5},
                {5, 4, 12.5}, {6, 4, 12.5}, {7, 7, 12.5e7}};
    double value;

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char *copy = malloc(rows[i].given); /* of exact size: asan sees an overrun */

        assert_non_null(copy);
        memcpy(copy, text, rows[i].given);
        assert_ptr_equal(number_read(copy, copy + rows[i].given, &value),
                         copy + rows[i].taken);
        assert_true(value == rows[i].value);
        free(copy);
    }
    assert_ptr_equal(number_read(comma, comma + 3, &value), comma + 1);
    assert_ptr_equal(number_read(hex, hex + 4, &value), hex + 1);
    assert_true(value == 0); /* no hexadecimal: it ends at the x */
}
