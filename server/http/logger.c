#include "logger.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "utc.h"
#include "utf8.h"

#define CLOSING 32 /* bytes kept for what logger_end() adds */

static enum logger_format format = LOGGER_LOGFMT;

void logger_use(enum logger_format f)
{
    format = f;
}

static void logger_put(struct logger_line *l, const char *s, size_t n)
{
    if (n > sizeof l->text - CLOSING - l->len) {
        l->full = true;
        return;
    }
    memcpy(l->text + l->len, s, n);
    l->len += n;
}

/* In double quotes, escaped as in JSON, which readers of logfmt understand too. */
static void put_quoted(struct logger_line *l, const char *s, size_t len)
{
    char code[8];

    logger_put(l, "\"", 1);
    for (size_t i = 0, n; i < len; i += n) {
        n = utf8_character(s + i, len - i);
        if (n == 0 || (n > 1 && utf8_is_control(s + i))) {
            logger_put(l, "\\ufffd", 6);
            n = 1;
        } else if (s[i] == '"' || s[i] == '\\') {
            logger_put(l, s[i] == '"' ? "\\\"" : "\\\\", 2);
        } else if (utf8_is_control(s + i)) {
            (void)snprintf(code, sizeof code, "\\u%04x", (unsigned)s[i]);
            logger_put(l, code, 6);
        } else {
            logger_put(l, s + i, n);
        }
    }
    logger_put(l, "\"", 1);
}

static void put_key(struct logger_line *l, const char *key)
{
    if (format == LOGGER_JSON) {
        logger_put(l, l->len > 1 ? ",\"" : "\"", l->len > 1 ? 2 : 1);
        logger_put(l, key, strlen(key));
        logger_put(l, "\":", 2);
    } else {
        logger_put(l, " ", l->len > 0);
        logger_put(l, key, strlen(key));
        logger_put(l, "=", 1);
    }
}

/* A field is there whole or not at all. */
static void logger_settle(struct logger_line *l, size_t before)
{
    if (l->full) {
        l->len = before;
        l->cut = true;
        l->full = false;
    }
}

void logger_text(struct logger_line *l, const char *key, const char *value)
{
    static const char bare[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                               "0123456789._-+:/{}@%,";
    size_t before = l->len, len = strnlen(value, LOG_VALUE_MAX);

    put_key(l, key);
    if (format == LOGGER_LOGFMT && len > 0 && strspn(value, bare) >= len)
        logger_put(l, value, len);
    else
        put_quoted(l, value, len);
    logger_settle(l, before);
}

static void put_number(struct logger_line *l, const char *key, const char *digits)
{
    size_t before = l->len;

    put_key(l, key);
    logger_put(l, digits, strlen(digits));
    logger_settle(l, before);
}

void logger_count(struct logger_line *l, const char *key, uint64_t value)
{
    char digits[24];

    (void)snprintf(digits, sizeof digits, "%" PRIu64, value);
    put_number(l, key, digits);
}

void logger_real(struct logger_line *l, const char *key, double value, int decimals)
{
    char digits[64];

    (void)snprintf(digits, sizeof digits, "%.*f", decimals, value);
    put_number(l, key, digits);
}

void logger_begin(struct logger_line *l, const char *level, const char *msg)
{
    char ts[UTC_TEXT];
    int64_t now;

    (void)utc_now(&now); /* else it is 1970, which tells */
    utc_print(now, ts);
    l->len = 0;
    l->full = l->cut = false;
    logger_put(l, "{", format == LOGGER_JSON);
    logger_text(l, "ts", ts);
    logger_text(l, "level", level);
    put_key(l, "msg"); /* quoted even if it is one word */
    put_quoted(l, msg, strnlen(msg, LOG_VALUE_MAX));
}

void logger_end(struct logger_line *l)
{
    static const char cut[2][16] = {" cut=true", ",\"cut\":true"};
    size_t n = l->cut ? strlen(cut[format == LOGGER_JSON]) : 0;

    memcpy(l->text + l->len, cut[format == LOGGER_JSON], n);
    l->len += n;
    if (format == LOGGER_JSON)
        l->text[l->len++] = '}';
    l->text[l->len++] = '\n';
    if (write(STDERR_FILENO, l->text, l->len) < 0)
        return; /* the log is closed */
}

void logger_line(const char *level, const char *msg, const char *key, const char *value)
{
    struct logger_line l;

    logger_begin(&l, level, msg);
    if (key != NULL)
        logger_text(&l, key, value);
    logger_end(&l);
}

uint64_t logger_seldom(struct logger_seldom *s, double now_ms)
{
    const uint64_t n = ++s->n;

    if (now_ms < s->next_ms)
        return 0;
    s->n = 0;
    s->next_ms = now_ms + LOG_SELDOM_MS;
    return n;
}

double logger_clock_ms(void)
{
    struct timespec ts;

    (void)clock_gettime(CLOCK_MONOTONIC, &ts);
    return (double)ts.tv_sec * 1e3 + (double)ts.tv_nsec * 1e-6;
}
