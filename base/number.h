/* number.h -- decimal text to double: correctly rounded, alike in every locale. */
#ifndef BASE_NUMBER_H
#define BASE_NUMBER_H

/* number_read(p, end, out): read the longest number at p that ends before `end`:
 * [+-] digits [. digits] [e [+-] digits], at least one digit before or after the point.
 * *out is the nearest double, ties to even; infinite when it is too large for one.
 * Returns the byte after the number, or NULL when there is none at p.  The text need not
 * end with NUL.  O(length). */
const char *number_read(const char *p, const char *end, double *out);

#endif
