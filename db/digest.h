/* digest.h -- a digest of a face's points. */
#ifndef DB_DIGEST_H
#define DB_DIGEST_H
#include "status.h"

struct surface_face; /* libsurface.h */

/* digest_points(m, hex): SHA-256 of the canonical points (FORMAT.md), in lower-case hex: a
 * function of the set of points alone, whatever their order.  O(nv log nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status digest_points(const struct surface_face *f, char hex[65]);

#endif
