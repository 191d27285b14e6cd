/* log.h -- one logfmt line an event, to stderr, in one write.  Nothing biometric, no token. */
#ifndef SERVER_LOG_H
#define SERVER_LOG_H

/* log_line(level, fmt, ...): ts=... level=LEVEL followed by the formatted rest, which is
 * "key=value key=value"; a value with spaces is quoted by the caller.  Control characters
 * in it become '?'.  At most 1,000 characters are written. */
__attribute__((format(printf, 2, 3))) void log_line(const char *level, const char *fmt,
                                                    ...);

/* log_clock_ms(): a monotonic clock, ms. */
double log_clock_ms(void);

#endif
