/* Numbers and texts as bytes: by hand, and truncated at every byte. */
#include <float.h>

#include "bytes.h"
#include "unit.h"

static const unsigned char by_hand[] = {
    0x34, 0x12,                                 /* 0x1234 */
    0,    0,    0,   0,    0,    0, 0xf8, 0x3f, /* 1.5 */
    3,    0,    'a', 0xc3, 0xa4,                /* "aä" */
    0xff,                                       /* 255 */
    7,    8,    9,                              /* themselves */
};

TEST(test_put)
{
    unsigned char out[sizeof by_hand], *to = out;

    bytes_put_number(&to, 0xf1234, 2);
    bytes_put_real(&to, 1.5);
    bytes_put_text(&to, "a\xc3\xa4");
    bytes_put_number(&to, UINT64_MAX, 1);
    bytes_put(&to, "\7\10\11", 3);
    assert_ptr_equal(to, out + sizeof out);
    assert_memory_equal(out, by_hand, sizeof out);
    assert_true(bytes_number(out, 8) == UINT64_C(0x1234));
    bytes_set(out, UINT64_C(0x0102030405060708), 8);
    assert_memory_equal(out, "\10\7\6\5\4\3\2\1", 8);
    assert_true(bytes_number(out, 8) == UINT64_C(0x0102030405060708));
}

static bool get_all(struct bytes *b)
{
    uint64_t v;
    double x;

    return bytes_get_number(b, 2, &v) && v == 0x1234 && bytes_get_finite(b, &x) &&
           x == 1.5 && bytes_get_number(b, 2, &v) && v == 3 &&
           bytes_get_number(b, 3, &v) && v == 0xa4c361 && bytes_get_number(b, 1, &v) &&
           v == 255 && bytes_get_number(b, 3, &v) && v == 0x090807;
}

TEST(test_get)
{
    for (size_t n = 0; n <= sizeof by_hand; n++) {
        struct bytes b = {by_hand, by_hand + n};

        assert_int_equal(get_all(&b), n == sizeof by_hand);
        assert_true(b.at <= b.end);
    }
}

TEST(test_cannot_be)
{
    static const double bad[] = {-DBL_MIN, 1.0000001, INFINITY, -INFINITY, NAN};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        unsigned char in[8], *to = in;
        struct bytes b;
        double x;

        bytes_put_real(&to, bad[i]);
        b = (struct bytes){in, to};
        assert_int_equal(bytes_get_finite(&b, &x), isfinite(bad[i]) != 0);
    }
}
