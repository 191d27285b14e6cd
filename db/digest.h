/* digest.h -- a digest of a face's points. */
#ifndef DB_DIGEST_H
#define DB_DIGEST_H
#include <stdbool.h>
#include "rows_types.h"
#include "status.h"

struct surface_face; /* libsurface.h */

/* digest_points(m, hex): SHA-256 of the canonical points (FORMAT.md), in lower-case hex: a
 * function of the set of points alone, whatever their order.  O(nv log nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status digest_points(const struct surface_face *f, char hex[65]);

/* Of the scans that a template was made from, as they were read: the digest of the first, 64
 * digits, then the first STORE_READ_OTHER of each other one's; "": unknown.
 *
 * digest_read_add(read, digest): appends one; those for which there is no room are left out. */
void digest_read_add(char read[STORE_READ_MAX + 1], const char *digest);

/* digest_read_has(read, digest): true if it is one of them. */
bool digest_read_has(const char *read, const char *digest);

#endif
