#include "utf8.h"

#include <stdint.h>
#include <string.h>

size_t utf8_character(const char *text, size_t len)
{
    const unsigned char *s = (const unsigned char *)text;
    const unsigned c = s[0];
    /* What the second byte may be: less than 0x80-0xbf after the four first bytes that could
     * begin an overlong form, a surrogate or a number above U+10FFFF. */
    const unsigned lo = c == 0xe0 ? 0xa0 : c == 0xf0 ? 0x90 : 0x80;
    const unsigned hi = c == 0xed ? 0x9f : c == 0xf4 ? 0x8f : 0xbf;
    const size_t n = c < 0x80                 ? 1
                     : c >= 0xc2 && c <= 0xdf ? 2
                     : (c & 0xf0) == 0xe0     ? 3
                     : c >= 0xf0 && c <= 0xf4 ? 4
                                              : 0;

    if (n > len || (n > 1 && (s[1] < lo || s[1] > hi)))
        return 0;
    for (size_t k = 2; k < n; k++)
        if ((s[k] & 0xc0) != 0x80)
            return 0;
    return n;
}

static uint32_t number(const unsigned char *s)
{
    if (s[0] < 0x80)
        return s[0];
    if (s[0] < 0xe0)
        return (s[0] & 0x1fU) << 6 | (s[1] & 0x3fU);
    if (s[0] < 0xf0)
        return (s[0] & 0xfU) << 12 | (s[1] & 0x3fU) << 6 | (s[2] & 0x3fU);
    return (s[0] & 7U) << 18 | (s[1] & 0x3fU) << 12 | (s[2] & 0x3fU) << 6 |
           (s[3] & 0x3fU);
}

bool utf8_is_control(const char *s)
{
    /* the controls; soft hyphen; bidi marks, isolates and overrides; characters without a width; line and
     * paragraph separator; tags */
    static const uint32_t range[][2] = {
        {0, 0x1f},        {0x7f, 0x9f},      {0xad, 0xad},     {0x61c, 0x61c},
        {0x180e, 0x180e}, {0x200b, 0x200f},  {0x2028, 0x202e}, {0x2060, 0x2069},
        {0xfeff, 0xfeff}, {0xe0000, 0xe007f}};
    const uint32_t c = number((const unsigned char *)s);

    for (size_t i = 0; i < sizeof range / sizeof *range; i++)
        if (c >= range[i][0] && c <= range[i][1])
            return true;
    return false;
}

size_t utf8_valid(const char *s, size_t len)
{
    size_t i = 0, n = 1;
    uint64_t word;

    while (i < len && n > 0) {
        while (len - i >= sizeof word && /* most of a text is ASCII */
               (memcpy(&word, s + i, sizeof word), word & UINT64_C(0x8080808080808080)) ==
                   0)
            i += sizeof word;
        n = i < len ? utf8_character(s + i, len - i) : 0;
        i += n;
    }
    return i;
}

bool utf8_is_text(const char *s, size_t max)
{
    const size_t len = strnlen(s, max + 1);
    size_t i = 0, n;

    while (i < len && (n = utf8_character(s + i, len - i)) > 0 && !utf8_is_control(s + i))
        i += n;
    return i == len && len <= max;
}
