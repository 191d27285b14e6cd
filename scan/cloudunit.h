/* cloudunit.h -- the units that the coordinates of a scan may be in. */
#ifndef SCAN_CLOUDUNIT_H
#define SCAN_CLOUDUNIT_H
#include <stdbool.h>
#include <stddef.h>

#define CLOUDUNIT_NAMES "mm, cm, m, in or um" /* for messages */

/* cloudunit_mm(name, len, mm): Sets *mm to the millimetres per unit.  Returns false if the name is no unit's. */
bool cloudunit_mm(const char *name, size_t len, double *mm);

/* cloudunit_or_auto(name, mm): Like cloudunit_mm(), and sets *mm to 0 for "auto". */
bool cloudunit_or_auto(const char *name, double *mm);

/* cloudunit_name(mm): Returns the name of a unit, as cloudunit_mm() takes it; "" if there is none. */
const char *cloudunit_name(double mm);

/* cloudunit_plural(mm): Returns the unit's word for messages, "metres"; "" if there is none. */
const char *cloudunit_plural(double mm);

#endif
