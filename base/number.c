/* Clinger, "How to Read Floating Point Numbers Accurately", PLDI 1990: a mantissa below
 * 2^53 and a power of ten up to 10^22 are both exact as doubles, so that one
 * multiplication or division rounds correctly.  Scanners' coordinates are all of this
 * kind.  Everything else goes to strtod() as digits and an exponent, without the decimal
 * point, which is all that a locale could change. */
#include "number.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* No decimal boundary between doubles has more than 768 significant digits: what follows
 * only says on which side of it the number lies, and one digit can say that. */
#define DIGITS_KEPT 780

#define EXPONENT_CLAMP INT64_C(99999) /* far beyond 10^308 with DIGITS_KEPT digits */

struct digits {
    uint64_t mantissa; /* the first up to 19 significant digits */
    uint32_t kept;     /* significant digits, at most DIGITS_KEPT */
    int64_t exponent;  /* value = digits kept * 10^exponent */
    bool dropped;      /* a digit other than 0 was left out after those kept */
};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Read digits; those after the decimal point lower the exponent.  text, unless NULL, gets
 * the digits kept. */
static const char *take_digits(struct digits *d, const char *p, const char *end,
                               bool after, char *text)
{
    for (; p < end && is_digit(*p); p++) {
        if (d->kept < DIGITS_KEPT) {
            if (text != NULL)
                text[d->kept] = *p;
            if (d->kept < 19)
                d->mantissa = 10 * d->mantissa + (uint64_t)(*p - '0');
            d->kept += (d->kept != 0) | (*p != '0'); /* leading zeros do not count */
            d->exponent -= after;
        } else {
            d->dropped |= *p != '0';
            d->exponent += !after;
        }
    }
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
    *value += negative ? -e : e;
    return q;
}

/* The digits stand at p; the exponent after them is e10. */
static double slow(const char *p, const char *end, int64_t e10)
{
    char text[DIGITS_KEPT + 32];
    struct digits d = {0, 0, e10, false};

    p = take_digits(&d, p, end, false, text);
    if (p < end && *p == '.')
        (void)take_digits(&d, p + 1, end, true, text);
    if (d.dropped) {
        text[d.kept++] = '1';
        d.exponent--;
    }
    if (d.exponent > EXPONENT_CLAMP)
        d.exponent = EXPONENT_CLAMP;
    else if (d.exponent < -EXPONENT_CLAMP)
        d.exponent = -EXPONENT_CLAMP;
    (void)snprintf(text + d.kept, sizeof text - d.kept, "e%d", (int)d.exponent);
    return strtod(text, NULL);
}

const char *number_read(const char *p, const char *end, double *out)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    struct digits d = {0, 0, 0, false};
    const char *first, *q;
    int64_t e10 = 0;
    bool negative = false, any;
    double value;

    if (p < end && (*p == '+' || *p == '-'))
        negative = *p++ == '-';
    first = p;
    q = take_digits(&d, p, end, false, NULL);
    any = q != p;
    if (q < end && *q == '.') {
        p = q + 1;
        q = take_digits(&d, p, end, true, NULL);
        any |= q != p;
    }
    if (!any)
        return NULL;
    q = take_exponent(q, end, &e10);
    d.exponent += e10;
    if (d.kept == 0)
        value = 0;
    else if (d.kept > 19 || d.mantissa > UINT64_C(1) << 53)
        value = slow(first, end, e10);
    else if (d.exponent >= 0 && d.exponent <= 22)
        value = (double)d.mantissa * power[d.exponent];
    else if (d.exponent < 0 && d.exponent >= -22)
        value = (double)d.mantissa / power[-d.exponent];
    else
        value = slow(first, end, e10);
    *out = negative ? -value : value;
    return q;
}
