#include "store_rules.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "errinfo.h"
#include "store_engine.h"

#define RANDOM_MAX 32
#define LAST_MS    INT64_C(253402300799999) /* of the year 9999 */

bool store_rules_consist(const char *text, const char *set, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    return n >= min && n <= max && strspn(text, set) == n;
}

bool store_subject_valid(const char *subject)
{
    return store_rules_consist(
        subject, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-@:", 1,
        STORE_SUBJECT_MAX);
}

bool store_id_valid(const char *id)
{
    return store_rules_consist(id, "0123456789abcdef", STORE_ID_LEN, STORE_ID_LEN);
}

bool store_rules_printable(const char *text, size_t min, size_t max)
{
    const size_t n = strnlen(text, max + 1);

    for (size_t i = 0; i < n; i++)
        if (text[i] < ' ' || text[i] > '~')
            return false;
    return n >= min && n <= max;
}

/* utf8_length(p): bytes of the well-formed character at p (RFC 3629), 0 if it is none. */
static size_t utf8_length(const unsigned char *p)
{
    const unsigned char c = p[0];

    if (c < 0x80)
        return 1;
    if (c < 0xc2 || c > 0xf4 || (p[1] & 0xc0) != 0x80)
        return 0;
    if (c < 0xe0)
        return 2;
    if ((p[2] & 0xc0) != 0x80 || (c == 0xe0 && p[1] < 0xa0) || (c == 0xed && p[1] > 0x9f))
        return 0;
    if (c < 0xf0)
        return 3;
    if ((p[3] & 0xc0) != 0x80 || (c == 0xf0 && p[1] < 0x90) || (c == 0xf4 && p[1] > 0x8f))
        return 0;
    return 4;
}

bool store_rules_text(const char *text, size_t max)
{
    const unsigned char *p = (const unsigned char *)text;
    size_t n;

    if (strnlen(text, max + 1) > max)
        return false;
    for (; *p != '\0'; p += n) {
        if ((n = utf8_length(p)) == 0 || *p < ' ' || *p == 0x7f ||
            (*p == 0xc2 && p[1] < 0xa0)) /* control characters of either set */
            return false;
    }
    return true;
}

enum status store_rules_subject(const char *subject, struct errinfo *e)
{
    if (store_subject_valid(subject))
        return ST_OK;
    return errinfo_set(
        e, ST_EINVAL,
        "a subject id is 1 to %d characters of A-Z a-z 0-9 . _ - @ :", STORE_SUBJECT_MAX);
}

enum status store_rules_id(const char *id, const char *what, struct errinfo *e)
{
    if (store_id_valid(id))
        return ST_OK;
    return errinfo_set(e, ST_EINVAL, "a %s id is %d characters of 0-9 a-f", what,
                       STORE_ID_LEN);
}

void store_rules_random(char *out, size_t bytes)
{
    unsigned char raw[RANDOM_MAX];

    randombytes_buf(raw, bytes);
    (void)sodium_bin2hex(out, 2 * bytes + 1, raw, bytes);
    sodium_memzero(raw, sizeof raw);
}

enum status store_rules_now(int64_t *ms, struct errinfo *e)
{
    struct timespec now;

    *ms = 0;
    if (clock_gettime(CLOCK_REALTIME, &now) != 0 || now.tv_sec < 0 ||
        now.tv_sec > LAST_MS / 1000)
        return errinfo_set(e, ST_EINTERNAL, "the system's clock cannot be read");
    *ms = (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
    return ST_OK;
}

void store_rules_time(int64_t ms, char out[STORE_RULES_TIME])
{
    struct tm tm = {0};
    time_t s;

    if (ms > LAST_MS)
        ms = LAST_MS;
    s = (time_t)(ms / 1000);
    (void)gmtime_r(&s, &tm);
    (void)snprintf(out, STORE_RULES_TIME, "%04u-%02u-%02uT%02u:%02u:%02u.%03uZ",
                   (unsigned)(tm.tm_year + 1900) % 10000, (unsigned)(tm.tm_mon + 1) % 100,
                   (unsigned)tm.tm_mday % 100, (unsigned)tm.tm_hour % 100,
                   (unsigned)tm.tm_min % 100, (unsigned)tm.tm_sec % 100,
                   (unsigned)(ms % 1000));
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

bool store_time_read(const char *text, int64_t *ms)
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

enum status store_rules_act(struct store_act *by, const char *actor, struct errinfo *e)
{
    enum status st;

    if (!store_rules_printable(actor, 0, STORE_NAME_MAX))
        return errinfo_set(e, ST_EINVAL, "an actor is up to %d printable characters",
                           STORE_NAME_MAX);
    by->actor = actor;
    if ((st = store_rules_now(&by->ms, e)) == ST_OK)
        store_rules_time(by->ms, by->at);
    return st;
}
