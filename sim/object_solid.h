/* object_solid.h -- the solid ones among the objects of object.h: each kind is a solid of a few
 * parts, and the sides from which it is seen. */
#ifndef TOOLS_OBJECT_SOLID_H
#define TOOLS_OBJECT_SOLID_H
#include <stddef.h>
#include <stdint.h>
#include "draw.h"
#include "vec.h"

#define OBJECT_SOLID_DRAWS 24 /* numbers between 0 and 1 that an object is drawn from */

uint32_t object_solid_kinds(void);
const char *object_solid_name(uint32_t kind);

/* object_solid_scan(kind, u, points, r, out): as object_scan(), drawn from u. */
size_t object_solid_scan(uint32_t kind, const double u[OBJECT_SOLID_DRAWS],
                         uint32_t points, struct draw *r, struct dvec3 *out);

#endif
