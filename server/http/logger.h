/* logger.h -- one line an event, to stderr, in one write: logfmt or JSON.  Nothing biometric,
 * no token, no subject.  Any thread.  A line is built in a struct logger_line:
 *     logger_begin(&l, "warn", "slow");  logger_text(&l, "route", name);  logger_end(&l);
 * Keys are our own words.  A value may be any bytes: bytes that could end it, or are not
 * UTF-8, are escaped, so that no sender can forge a field or a line. */
#ifndef SERVER_LOGGER_H
#define SERVER_LOGGER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOG_LINE_MAX                                                                     \
    2048 /* bytes; fields that do not fit are left out, and cut=true says so */
#define LOG_VALUE_MAX 600 /* bytes of a value that are taken */

struct logger_line {
    char text[LOG_LINE_MAX];
    size_t len;
    bool full, cut;
};

enum logger_format { LOGGER_LOGFMT, LOGGER_JSON };

/* logger_use(format): LOGGER_LOGFMT until then.  Before other threads log. */
void logger_use(enum logger_format format);

/* logger_begin(l, level, msg): the time, the level ("info", "warn", "error") and what it is. */
void logger_begin(struct logger_line *l, const char *level, const char *msg);
void logger_text(struct logger_line *l, const char *key, const char *value);
void logger_count(struct logger_line *l, const char *key, uint64_t value);

/* logger_real(l, key, value, decimals): finite. */
void logger_real(struct logger_line *l, const char *key, double value, int decimals);

/* logger_end(l): write it. */
void logger_end(struct logger_line *l);

/* logger_line(level, fmt, ...): a line that is a message alone. */
__attribute__((format(printf, 2, 3))) void logger_line(const char *level, const char *fmt,
                                                       ...);

/* logger_clock_ms(): a monotonic clock, ms. */
double logger_clock_ms(void);

#define LOG_SELDOM_MS 60000.0

/* What strangers can cause as often as they like gets a line a minute.  All zero at first. */
struct logger_seldom {
    uint64_t n; /* since the last line */
    double next_ms;
};

/* logger_seldom(s, now_ms): it happened once more.  Returns how often since the last line, where
 * another one is due; else 0.  The caller locks. */
uint64_t logger_seldom(struct logger_seldom *s, double now_ms);

#endif
