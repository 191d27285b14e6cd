#define _DEFAULT_SOURCE /* timegm() */
#include "utc.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#define DAY_MS  INT64_C(86400000)
#define LAST_MS INT64_C(253402300799999) /* of the year 9999 */

bool utc_now(int64_t *ms)
{
    struct timespec now;

    *ms = 0;
    if (clock_gettime(CLOCK_REALTIME, &now) != 0 || now.tv_sec < 0 ||
        now.tv_sec > LAST_MS / 1000)
        return false;
    *ms = (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
    return true;
}

void utc_print(int64_t ms, char out[UTC_TEXT])
{
    struct tm tm = {0};
    time_t s;
    size_t n;

    if (ms > LAST_MS)
        ms = LAST_MS;
    s = (time_t)(ms / 1000);
    (void)gmtime_r(&s, &tm);
    n = strftime(out, UTC_TEXT, "%Y-%m-%dT%H:%M:%S", &tm);
    (void)snprintf(out + n, UTC_TEXT - n, ".%03dZ", (int)(ms % 1000));
}

/* Exactly n digits as a number; false: others. */
static bool digits(const char **text, int n, int *out)
{
    *out = 0;
    for (; n > 0; n--, ++*text) {
        if (**text < '0' || **text > '9')
            return false;
        *out = 10 * *out + (**text - '0');
    }
    return true;
}

static bool letter(const char **text, char c)
{
    return *(*text)++ == c;
}

/* "2027-01-31" as days since 1970. */
static bool read_day(const char **text, int64_t *out)
{
    struct tm day = {0};
    int y, m, d;

    if (!digits(text, 4, &y) || !letter(text, '-') || !digits(text, 2, &m) ||
        !letter(text, '-') || !digits(text, 2, &d) || y < 1970)
        return false;
    day.tm_year = y - 1900;
    day.tm_mon = m - 1;
    day.tm_mday = d;
    *out = (int64_t)timegm(&day) / (DAY_MS / 1000);
    /* timegm() has moved a day that does not exist. */
    return day.tm_mon == m - 1 && day.tm_mday == d;
}

/* "Z" or "+01:00" as milliseconds. */
static bool read_zone(const char **text, int64_t *out)
{
    const char sign = *(*text)++;
    int h, m;

    *out = 0;
    if (sign == 'Z')
        return true;
    if ((sign != '+' && sign != '-') || !digits(text, 2, &h) || !letter(text, ':') ||
        !digits(text, 2, &m) || h > 23 || m > 59)
        return false;
    *out = (h * 60 + m) * (sign == '+' ? INT64_C(60000) : INT64_C(-60000));
    return true;
}

bool utc_read(const char *text, int64_t *ms)
{
    int64_t day, zone = 0;
    int h = 0, m = 0, s = 0, fraction = 0, digit = 100;

    if (!read_day(&text, &day))
        return false;
    if (*text != '\0') {
        if (!letter(&text, 'T') || !digits(&text, 2, &h) || !letter(&text, ':') ||
            !digits(&text, 2, &m) || !letter(&text, ':') || !digits(&text, 2, &s) ||
            h > 23 || m > 59 || s > 59)
            return false;
        if (*text == '.') {
            if (*++text < '0' || *text > '9')
                return false;
            for (; *text >= '0' && *text <= '9'; text++, digit /= 10)
                fraction += (*text - '0') * digit;
        }
        if (!read_zone(&text, &zone) || *text != '\0')
            return false;
    }
    *ms = (((day * 24 + h) * 60 + m) * 60 + s) * 1000 + fraction - zone;
    return *ms >= 0 && *ms <= LAST_MS;
}

bool utc_read_end(const char *text, int64_t *ms)
{
    if (!utc_read(text, ms))
        return false;
    if (strlen(text) == sizeof "2027-01-31" - 1)
        *ms += DAY_MS - 1;
    return true;
}
