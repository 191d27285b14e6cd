/* series.h -- functions of the C library whose last digit depends on the library, by series of our own: of + - * /
 * and sqrt() alone they give the same digits everywhere. */
#ifndef CORE_SERIES_H
#define CORE_SERIES_H

/* series_ln(x): Returns the natural logarithm of a positive, finite x; to 1e-15 of its size or better. */
double series_ln(double x);

/* series_degrees(y, x): Returns the angle from the x axis to (x, y), as atan2(), but in degrees, -180..180, and 0 if
 * both are 0; to 1e-13.  A zero has no sign. */
double series_degrees(double y, double x);

#endif
