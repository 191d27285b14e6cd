/* utc.h -- times as milliseconds since 1970, UTC, without leap seconds, and as RFC
 * 3339. */
#ifndef BASE_UTC_H
#define BASE_UTC_H
#include <stdbool.h>
#include <stdint.h>

#define UTC_TEXT 32 /* bytes for a time as text */

/* utc_now(ms): the system's clock, which may be set back.  False, and *ms is 0: it cannot
 * be read or stands outside of 1970 to 9999. */
bool utc_now(int64_t *ms);

/* utc_print(ms, out): "2027-01-31T13:30:00.000Z", always so long, so that times compare
 * like their texts.  ms: 0 or more; one past the year 9999 becomes its end. */
void utc_print(int64_t ms, char out[UTC_TEXT]);

/* utc_read(text, ms): RFC 3339, "2027-01-31T14:30:00+01:00", what is finer than a
 * millisecond cut off, or the beginning of a day, "2027-01-31" (UTC).  False: neither, or
 * outside of 1970 to 9999. */
bool utc_read(const char *text, int64_t *ms);

/* utc_read_end(text, ms): the same of an end: a day without a time is its last millisecond. */
bool utc_read_end(const char *text, int64_t *ms);

#endif
