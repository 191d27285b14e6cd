#include "utc.h"

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

/* n digits of v, and what follows them. */
static char *utc_put(char *to, int v, int n, char after)
{
    for (int i = n - 1; i >= 0; i--, v /= 10)
        to[i] = (char)('0' + v % 10);
    to[n] = after;
    return to + n + 1;
}

void utc_print(int64_t ms, char out[UTC_TEXT])
{
    struct tm tm = {0};
    time_t s;

    if (ms > LAST_MS)
        ms = LAST_MS;
    s = (time_t)(ms / 1000);
    (void)gmtime_r(&s, &tm);
    out = utc_put(out, tm.tm_year + 1900, 4, '-');
    out = utc_put(out, tm.tm_mon + 1, 2, '-');
    out = utc_put(out, tm.tm_mday, 2, 'T');
    out = utc_put(out, tm.tm_hour, 2, ':');
    out = utc_put(out, tm.tm_min, 2, ':');
    out = utc_put(out, tm.tm_sec, 2, '.');
    out = utc_put(out, (int)(ms % 1000), 3, 'Z');
    *out = '\0';
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
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int y, m, d;
    bool leap;

    if (!digits(text, 4, &y) || !letter(text, '-') || !digits(text, 2, &m) ||
        !letter(text, '-') || !digits(text, 2, &d))
        return false;
    leap = y % 4 == 0 && (y % 100 != 0 || y % 400 == 0);
    if (y < 1970 || m < 1 || m > 12 || d < 1 || d > days[m - 1] + (leap && m == 2))
        return false;
    *out = (y - 1970) * INT64_C(365) + (y - 1969) / 4 - (y - 1901) / 100 +
           (y - 1601) / 400 + d - 1;
    for (int i = 0; i < m - 1; i++)
        *out += days[i] + (leap && i == 1);
    return true;
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
