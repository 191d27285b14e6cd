/* log.h -- one line an event, to stderr, in one write: logfmt or JSON.  Nothing biometric,
 * no token, no subject.  Any thread; a line is put together in a struct log_entry:
 *     log_begin(&l, "warn", "slow");  log_text(&l, "route", name);  log_end(&l);
 * Keys are our own words.  A value may be any bytes: what could end it, or is not UTF-8, is
 * escaped, so that nobody who sends it can forge a field or a line. */
#ifndef SERVER_LOG_H
#define SERVER_LOG_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOG_LINE_MAX                                                                     \
    2048 /* bytes; fields that do not fit are left out, and cut=true says so */
#define LOG_VALUE_MAX 600 /* bytes of a value that are taken */

struct log_entry {
    char text[LOG_LINE_MAX];
    size_t len;
    bool full, cut;
};

enum log_format { LOG_LOGFMT, LOG_JSON };

/* log_use(format): LOG_LOGFMT until then.  Before other threads log. */
void log_use(enum log_format format);

/* log_begin(l, level, msg): the time, the level ("info", "warn", "error") and what it is. */
void log_begin(struct log_entry *l, const char *level, const char *msg);
void log_text(struct log_entry *l, const char *key, const char *value);
void log_count(struct log_entry *l, const char *key, uint64_t value);

/* log_real(l, key, value, decimals): finite. */
void log_real(struct log_entry *l, const char *key, double value, int decimals);

/* log_end(l): write it. */
void log_end(struct log_entry *l);

/* log_line(level, fmt, ...): a line that is a message alone. */
__attribute__((format(printf, 2, 3))) void log_line(const char *level, const char *fmt,
                                                    ...);

/* log_clock_ms(): a monotonic clock, ms. */
double log_clock_ms(void);

#define LOG_SELDOM_MS 60000.0

/* What strangers can cause as often as they like gets a line a minute.  All zero at first. */
struct log_seldom {
    uint64_t n; /* since the last line */
    double next_ms;
};

/* log_seldom(s, now_ms): it happened once more.  Returns how often since the last line, where
 * another one is due; else 0.  The caller locks. */
uint64_t log_seldom(struct log_seldom *s, double now_ms);

#endif
