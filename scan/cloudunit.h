/* cloudunit.h -- the units that the coordinates of a scan may be in. */
#ifndef SCAN_CLOUDUNIT_H
#define SCAN_CLOUDUNIT_H
#include <stdbool.h>
#include <stddef.h>

#define CLOUDUNIT_NAMES "mm, cm, m, in or um" /* for messages */

/* cloudunit_mm(name, len, mm): millimetres per unit; false: it is none of the names.
 * cloudunit_or_auto(): likewise, or 0 for "auto". */
bool cloudunit_mm(const char *name, size_t len, double *mm);
bool cloudunit_or_auto(const char *name, double *mm);

/* cloudunit_name(mm): the name of such a unit, as cloudunit_mm() takes it; "": of none.
 * cloudunit_plural(mm): "metres"; likewise. */
const char *cloudunit_name(double mm);
const char *cloudunit_plural(double mm);

#endif
