/* number.h -- decimal text to double, correctly rounded. */
#ifndef BASE_NUMBER_H
#define BASE_NUMBER_H

#define NUMBER_MAX 1000 /* bytes of a number */

/* number_read(p, end, out): Reads the longest number at p that ends at or before `end`:
 * [+-] digits [. digits] [e [+-] digits], with at least one digit before or after the point.
 *   out     the nearest double, ties to even; infinite if the number is too large for one
 * The text need not end with NUL.
 * Cost: O(length); a tenth of strtod() for 6 decimals, half of it for the 17 digits of a double.
 * Returns the byte after the number; NULL if there is none at p, or one of more than NUMBER_MAX bytes. */
const char *number_read(const char *p, const char *end, double *out);

#endif
