
#include "unit.h"
#include "utf8.h"

/* Encodes c by Unicode's table 3-6; returns the number of bytes, 0 if c is no character. */
static size_t encode(uint32_t c, char *out)
{
    if (c >= 0xd800 && c <= 0xdfff)
        return 0;
    if (c < 0x80) {
        out[0] = (char)c;
        return 1;
    }
    if (c < 0x800) {
        out[0] = (char)(0xc0 | c >> 6);
        out[1] = (char)(0x80 | (c & 0x3f));
        return 2;
    }
    if (c < 0x10000) {
        out[0] = (char)(0xe0 | c >> 12);
        out[1] = (char)(0x80 | (c >> 6 & 0x3f));
        out[2] = (char)(0x80 | (c & 0x3f));
        return 3;
    }
    out[0] = (char)(0xf0 | c >> 18);
    out[1] = (char)(0x80 | (c >> 12 & 0x3f));
    out[2] = (char)(0x80 | (c >> 6 & 0x3f));
    out[3] = (char)(0x80 | (c & 0x3f));
    return 4;
}

/* Every character is valid if complete, and invalid if truncated. */
TEST(test_characters)
{
    char s[8];
    size_t count = 0;

    for (uint32_t c = 0; c <= 0x10ffff; c++) {
        const size_t n = encode(c, s);

        if (n == 0)
            continue;
        assert_int_equal(utf8_valid(s, n), n);
        if (n > 1)
            assert_int_equal(utf8_valid(s, n - 1), 0);
        count++;
    }
    assert_int_equal(count, 0x110000 - 0x800);
}

/* What is wrong is found at its place, wherever it stands in a long text. */
TEST(test_place)
{
    char s[40];

    for (size_t i = 0; i < sizeof s; i++)
        for (size_t len = i + 1; len <= sizeof s; len++) {
            memset(s, 'a', sizeof s);
            assert_int_equal(utf8_valid(s, len), len);
            s[i] = (char)0x80;
            assert_int_equal(utf8_valid(s, len), i);
            s[i] = (char)0xc3;
            assert_int_equal(utf8_valid(s, len), i);
            if (i + 1 < len) {
                s[i + 1] = (char)0xa4;
                assert_int_equal(utf8_valid(s, len), len);
            }
        }
}

/* The number of valid sequences of one to four bytes is the number of such characters; of
 * four bytes only those that end in 0x80 are tried. */
TEST(test_sequences)
{
    size_t one = 0, two = 0, three = 0, four = 0;
    char s[4];

    for (uint32_t c = 0; c < 1U << 24; c++) {
        s[0] = (char)(c >> 16);
        s[1] = (char)(c >> 8 & 0xff);
        s[2] = (char)(c & 0xff);
        s[3] = (char)0x80;
        if (c < 256) {
            s[0] = (char)c;
            one += utf8_valid(s, 1) == 1;
            s[0] = 0;
        }
        if ((unsigned char)s[0] < 0x80)
            continue; /* a character of one byte, and others: counted separately */
        two += (c & 0xff) == 0 && utf8_valid(s, 2) == 2;
        three += utf8_valid(s, 3) == 3 && utf8_valid(s, 2) == 0;
        four += utf8_valid(s, 4) == 4 && utf8_valid(s, 3) == 0;
    }
    assert_int_equal(one, 0x80);
    assert_int_equal(two, 0x800 - 0x80);
    assert_int_equal(three, 0x10000 - 0x800 - 0x800);
    assert_int_equal(four, 0x100000 / 64);
}

TEST(test_text)
{
    char s[8] = "";
    unsigned controls = 0;

    for (uint32_t c = 1; c <= 0x10ffff; c++) {
        const size_t n = encode(c, s);

        s[n] = '\0';
        if (n == 0)
            continue;
        assert_true(utf8_is_text(s, 4) != utf8_is_control(s));
        assert_false(utf8_is_text(s, n - 1));
        controls += utf8_is_control(s);
    }
    assert_int_equal(controls, 0x1f + 1 + 0x20 + 1 + 1 + 1 + 5 + 7 + 10 + 1 + 0x80);
    assert_true(utf8_is_control(""));
    assert_true(utf8_is_control("\u202e") && utf8_is_control("\u200d"));
    assert_false(utf8_is_text("Anna\u202e", 99));
    assert_true(utf8_is_text("", 0));
    assert_true(utf8_is_text("a\xc3\xa4", 3));
    assert_false(utf8_is_text("a\xc3\xa4", 2));
    assert_false(utf8_is_text("a\xc3", 9));
    assert_false(utf8_is_text("a\tb", 9));
}
