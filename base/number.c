/* Clinger, "How to Read Floating Point Numbers Accurately", PLDI 1990: a mantissa below 2^53 and a
 * power of ten up to 10^22 are both exact as doubles, so that one multiplication or division rounds
 * correctly.  Scanners' coordinates are of this kind, or floats printed with the digits of a double:
 * up to 19, divided as whole numbers.  strtod() reads every other number. */
#include "number.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define WHOLE_DIGITS 19 /* as many as always fit 64 bits */

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Reads digits into *mantissa, which overflows if they are more than WHOLE_DIGITS. */
static const char *take_digits(const char *p, const char *end, uint64_t *mantissa)
{
    for (; p < end && is_digit(*p); p++)
        *mantissa = 10 * *mantissa + (uint64_t)(*p - '0');
    return p;
}

/* Read an exponent at p, if there is a whole one, into *value. */
static const char *take_exponent(const char *p, const char *end, int64_t *value)
{
    const char *q = p;
    bool negative = false;
    int64_t e = 0;

    if (q == end || (*q != 'e' && *q != 'E'))
        return p;
    q++;
    if (q < end && (*q == '+' || *q == '-'))
        negative = *q++ == '-';
    if (q == end || !is_digit(*q))
        return p;
    for (; q < end && is_digit(*q); q++)
        if (e < INT64_C(1) << 50)
            e = 10 * e + (*q - '0');
    *value = negative ? -e : e;
    return q;
}

/* mantissa / 10^places, for 1 to WHOLE_DIGITS places.  The quotient has 64 bits or more;
 * with its lowest bit set for a remainder it rounds like the exact value. */
static double divide(uint64_t mantissa, int places)
{
    __extension__ typedef unsigned __int128 wide;
    const int shift = 64 + __builtin_clzll(mantissa);
    const wide dividend = (wide)mantissa << shift;
    uint64_t divisor = 1;
    wide quotient;

    while (places-- > 0)
        divisor *= 10;
    quotient = dividend / divisor;
    return ldexp((double)(quotient | (quotient * divisor != dividend)), -shift);
}

/* The number from first to end, of up to NUMBER_MAX bytes; no program sets a locale. */
static double slow(const char *first, const char *end)
{
    char text[NUMBER_MAX + 1];
    const size_t n = (size_t)(end - first);

    memcpy(text, first, n);
    text[n] = '\0';
    return strtod(text, NULL);
}

const char *number_read(const char *p, const char *end, double *out)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const bool negative = p < end && *p == '-';
    const char *const first = p + (p < end && (*p == '+' || *p == '-')), *point;
    const char *q;
    uint64_t mantissa = 0;
    int64_t digits, places = 0, e10 = 0;
    double value;

    q = point = take_digits(first, end, &mantissa);
    digits = q - first;
    if (q < end && *q == '.') {
        q = take_digits(q + 1, end, &mantissa);
        places = q - point - 1;
    }
    digits += places;
    if (digits == 0)
        return NULL;
    q = take_exponent(q, end, &e10);
    places -= e10;
    if (q - p > NUMBER_MAX)
        return NULL;
    if (digits > WHOLE_DIGITS)
        value = slow(first, q);
    else if (mantissa == 0)
        value = 0;
    else if (mantissa <= UINT64_C(1) << 53 && places >= -22 && places <= 22)
        value = places < 0 ? (double)mantissa * power[-places]
                           : (double)mantissa / power[places];
    else if (places > 0 && places <= WHOLE_DIGITS)
        value = divide(mantissa, (int)places);
    else
        value = slow(first, q);
    *out = negative ? -value : value;
    return q;
}
