/* logger.h -- writes one line for each event to stderr, in one write: logfmt or JSON.  Nothing biometric, no
 * token, no subject.  Any thread.  A line is built in a struct logger_line:
 *     logger_begin(&l, "warn", "slow");  logger_text(&l, "route", name);  logger_end(&l);
 * Keys are words of the program.  A value may be any bytes: those that could end it, or are not UTF-8, are
 * escaped, so that no sender can forge a field or a line. */
#ifndef SERVER_LOGGER_H
#define SERVER_LOGGER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOG_LINE_MAX                                                                     \
    2048 /* bytes of a line; if a field does not fit, it is left out, and cut=true added */
#define LOG_VALUE_MAX 600 /* bytes of a value; the rest is left out */

struct logger_line {
    char text[LOG_LINE_MAX];
    size_t len;
    bool full, cut;
};

enum logger_format { LOGGER_LOGFMT, LOGGER_JSON };

/* logger_use(format): Sets the format, which is LOGGER_LOGFMT at first.  Before other threads log. */
void logger_use(enum logger_format format);

/* logger_begin(l, level, msg): Begins a line with the time, the level ("info", "warn", "error") and the message. */
void logger_begin(struct logger_line *l, const char *level, const char *msg);

/* logger_text(l, key, value): Adds a field. */
void logger_text(struct logger_line *l, const char *key, const char *value);

/* logger_count(l, key, value): Adds a field with an integer. */
void logger_count(struct logger_line *l, const char *key, uint64_t value);

/* logger_real(l, key, value, decimals): Adds a field with a finite number. */
void logger_real(struct logger_line *l, const char *key, double value, int decimals);

/* logger_end(l): Writes the line. */
void logger_end(struct logger_line *l);

/* logger_line(level, msg, key, value): Writes a line with one field.
 *   key  NULL: the message alone */
void logger_line(const char *level, const char *msg, const char *key, const char *value);

/* logger_clock_ms(): Returns the time of a monotonic clock, ms. */
double logger_clock_ms(void);

#define LOG_SELDOM_MS 60000.0

/* Counts events that any client can cause as often as it likes, for one line a minute.  All zero at first. */
struct logger_seldom {
    uint64_t n;     /* events since the last line */
    double next_ms; /* time of the next line */
};

/* logger_seldom(s, now_ms): Counts one more event.  If a line is due, returns the number of events since the last
 * one; else 0.  The caller locks s. */
uint64_t logger_seldom(struct logger_seldom *s, double now_ms);

#endif
