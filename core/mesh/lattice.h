/* lattice.h -- coordinates become integers.
 * Scanners resolve 20 um at best, so a grid of 1 um loses nothing.  On integers the
 * predicates are exact, and the same bytes give the same digits on every machine. */
#ifndef CORE_LATTICE_H
#define CORE_LATTICE_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"
#include "vec.h"

#define LATTICE_PER_MM 1000.0             /* lattice units per millimetre, for faces */
#define LATTICE_MAX    (INT32_C(1) << 24) /* |coordinate| <= this: incircle fits 128 bits */

/* lattice_from_mm(pts, n, scale, out, bad): Sets out[0..n-1] to the n points, each coordinate the
 * nearest lattice coordinate, ties to even.
 *   scale  lattice units per millimetre
 *   out    unspecified on failure
 *   bad    receives on failure the index of the first bad point; may be NULL
 * Returns ST_OK; ST_ENOTFINITE; ST_ERANGE: beyond LATTICE_MAX. */
enum status lattice_from_mm(const struct dvec3 *pts, size_t n, double scale,
                            struct ivec3 *out, size_t *bad);

/* lattice_to_mm(p, z): Returns a lattice point in mm. */
static inline struct dvec3 lattice_to_mm(struct ivec2 p, int32_t z)
{
    return (struct dvec3){p.x / LATTICE_PER_MM, p.y / LATTICE_PER_MM, z / LATTICE_PER_MM};
}

#endif
