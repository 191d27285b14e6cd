#include "log.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define CLOSING 32 /* bytes kept for what log_end() adds */

static enum log_format format = LOG_LOGFMT;

void log_use(enum log_format f)
{
    format = f;
}

static void put(struct log_entry *l, const char *s, size_t n)
{
    if (n > sizeof l->text - CLOSING - l->len) {
        l->full = true;
        return;
    }
    memcpy(l->text + l->len, s, n);
    l->len += n;
}

/* The length of the UTF-8 character at s, shortest form and no surrogate; 0: it is none, or
 * a control character of Latin-1, which terminals obey. */
static size_t utf8_length(const unsigned char *s, size_t left)
{
    static const uint32_t least[] = {0, 0, 0xa0, 0x800, 0x10000};
    size_t n = *s < 0x80   ? 1
               : *s < 0xc2 ? 0
               : *s < 0xe0 ? 2
               : *s < 0xf0 ? 3
               : *s < 0xf5 ? 4
                           : 0;
    uint32_t c;

    if (n <= 1 || n > left)
        return n <= left ? n : 0;
    c = *s & (0x7fu >> n);
    for (size_t i = 1; i < n; i++) {
        if ((s[i] & 0xc0) != 0x80)
            return 0;
        c = c << 6 | (s[i] & 0x3f);
    }
    return c < least[n] || c > 0x10ffff || (c >= 0xd800 && c < 0xe000) ? 0 : n;
}

/* In double quotes, escaped as in JSON, which readers of logfmt understand too. */
static void put_quoted(struct log_entry *l, const char *s, size_t len)
{
    const unsigned char *p = (const unsigned char *)s;
    char code[8];

    put(l, "\"", 1);
    for (size_t i = 0, n; i < len; i += n) {
        n = utf8_length(p + i, len - i);
        if (n == 0) {
            put(l, "\\ufffd", 6);
            n = 1;
        } else if (p[i] == '"' || p[i] == '\\') {
            put(l, p[i] == '"' ? "\\\"" : "\\\\", 2);
        } else if (p[i] < ' ' || p[i] == 0x7f) {
            (void)snprintf(code, sizeof code, "\\u%04x", (unsigned)p[i]);
            put(l, code, 6);
        } else {
            put(l, s + i, n);
        }
    }
    put(l, "\"", 1);
}

static void put_key(struct log_entry *l, const char *key)
{
    if (format == LOG_JSON) {
        put(l, l->len > 1 ? ",\"" : "\"", l->len > 1 ? 2 : 1);
        put(l, key, strlen(key));
        put(l, "\":", 2);
    } else {
        put(l, " ", l->len > 0);
        put(l, key, strlen(key));
        put(l, "=", 1);
    }
}

/* A field is there whole or not at all. */
static void settle(struct log_entry *l, size_t before)
{
    if (l->full) {
        l->len = before;
        l->cut = true;
        l->full = false;
    }
}

void log_text(struct log_entry *l, const char *key, const char *value)
{
    static const char bare[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                               "0123456789._-+:/{}@%,";
    size_t before = l->len, len = strnlen(value, LOG_VALUE_MAX);

    put_key(l, key);
    if (format == LOG_LOGFMT && len > 0 && strspn(value, bare) >= len)
        put(l, value, len);
    else
        put_quoted(l, value, len);
    settle(l, before);
}

static void put_number(struct log_entry *l, const char *key, const char *digits)
{
    size_t before = l->len;

    put_key(l, key);
    put(l, digits, strlen(digits));
    settle(l, before);
}

void log_count(struct log_entry *l, const char *key, uint64_t value)
{
    char digits[24];

    (void)snprintf(digits, sizeof digits, "%" PRIu64, value);
    put_number(l, key, digits);
}

void log_real(struct log_entry *l, const char *key, double value, int decimals)
{
    char digits[64];

    (void)snprintf(digits, sizeof digits, "%.*f", decimals, value);
    put_number(l, key, digits);
}

void log_begin(struct log_entry *l, const char *level, const char *msg)
{
    char ts[48];
    struct timespec now;
    struct tm tm;
    size_t len;

    (void)clock_gettime(CLOCK_REALTIME, &now);
    (void)gmtime_r(&now.tv_sec, &tm);
    len = strftime(ts, sizeof ts, "%Y-%m-%dT%H:%M:%S", &tm);
    (void)snprintf(ts + len, sizeof ts - len, ".%03ldZ", now.tv_nsec / 1000000);
    l->len = 0;
    l->full = l->cut = false;
    put(l, "{", format == LOG_JSON);
    log_text(l, "ts", ts);
    log_text(l, "level", level);
    put_key(l, "msg"); /* quoted also where it is one word */
    put_quoted(l, msg, strnlen(msg, LOG_VALUE_MAX));
}

void log_end(struct log_entry *l)
{
    static const char cut[2][16] = {" cut=true", ",\"cut\":true"};
    size_t n = l->cut ? strlen(cut[format == LOG_JSON]) : 0;

    memcpy(l->text + l->len, cut[format == LOG_JSON], n);
    l->len += n;
    if (format == LOG_JSON)
        l->text[l->len++] = '}';
    l->text[l->len++] = '\n';
    if (write(STDERR_FILENO, l->text, l->len) < 0)
        return; /* nobody is there to be told */
}

void log_line(const char *level, const char *fmt, ...)
{
    struct log_entry l;
    char msg[LOG_VALUE_MAX];
    va_list ap;

    va_start(ap, fmt);
    (void)vsnprintf(msg, sizeof msg, fmt, ap);
    va_end(ap);
    log_begin(&l, level, msg);
    log_end(&l);
}

double log_clock_ms(void)
{
    struct timespec ts;

    (void)clock_gettime(CLOCK_MONOTONIC, &ts);
    return (double)ts.tv_sec * 1e3 + (double)ts.tv_nsec * 1e-6;
}
