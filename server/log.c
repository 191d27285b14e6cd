#include "log.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "utc.h"
#include "utf8.h"

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

/* In double quotes, escaped as in JSON, which readers of logfmt understand too. */
static void put_quoted(struct log_entry *l, const char *s, size_t len)
{
    char code[8];

    put(l, "\"", 1);
    for (size_t i = 0, n; i < len; i += n) {
        n = utf8_character(s + i, len - i);
        if (n == 0 || (n == 2 && utf8_is_control(s + i))) {
            put(l, "\\ufffd", 6);
            n = 1;
        } else if (s[i] == '"' || s[i] == '\\') {
            put(l, s[i] == '"' ? "\\\"" : "\\\\", 2);
        } else if (utf8_is_control(s + i)) {
            (void)snprintf(code, sizeof code, "\\u%04x", (unsigned)s[i]);
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
    char ts[UTC_TEXT];
    int64_t now;

    (void)utc_now(&now); /* else it is 1970, which tells */
    utc_print(now, ts);
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

uint64_t log_seldom(struct log_seldom *s, double now_ms)
{
    const uint64_t n = ++s->n;

    if (now_ms < s->next_ms)
        return 0;
    s->n = 0;
    s->next_ms = now_ms + LOG_SELDOM_MS;
    return n;
}

double log_clock_ms(void)
{
    struct timespec ts;

    (void)clock_gettime(CLOCK_MONOTONIC, &ts);
    return (double)ts.tv_sec * 1e3 + (double)ts.tv_nsec * 1e-6;
}
