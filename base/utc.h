/* utc.h -- times as milliseconds since 1970, UTC, without leap seconds, and as texts of RFC 3339. */
#ifndef BASE_UTC_H
#define BASE_UTC_H
#include <stdbool.h>
#include <stdint.h>

#define UTC_TEXT 32 /* bytes for a time as text */

/* utc_now(ms): Reads the system's clock, which may be set back.
 * Returns false, and sets *ms to 0, if the clock cannot be read or is outside of 1970 to 9999. */
bool utc_now(int64_t *ms);

/* utc_print(ms, out): Prints "2027-01-31T13:30:00.000Z", always of this length, so that texts are ordered like
 * their times.
 *   ms      0 or more; a time after the year 9999 becomes its end */
void utc_print(int64_t ms, char out[UTC_TEXT]);

/* utc_read(text, ms): Reads a time of RFC 3339, "2027-01-31T14:30:00+01:00", cut off at milliseconds, or the
 * beginning of a day, "2027-01-31" (UTC).
 * Returns false if text is neither, or outside of 1970 to 9999. */
bool utc_read(const char *text, int64_t *ms);

/* utc_read_end(text, ms): Like utc_read(), but a day without a time is its last millisecond. */
bool utc_read_end(const char *text, int64_t *ms);

#endif
