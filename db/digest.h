/* digest.h -- the digests by which points are found again: those of a face, and those of a scan. */
#ifndef DB_DIGEST_H
#define DB_DIGEST_H
#include <stdbool.h>
#include "rows_types.h"
#include "status.h"

struct cloudpoints;  /* cloudpoints.h */
struct surface_face; /* libsurface.h */

/* digest_face(f, hex): Computes the SHA-256 of the canonical points (FORMAT.md), in lower-case hex.  It
 * depends only on the set of points.  O(n log n).  Returns ST_OK, ST_ENOMEM. */
enum status digest_face(const struct surface_face *f, char hex[65]);

/* digest_scan(c, hex): Computes the digest of the points of a scan as they were read, in lower-case hex.
 * It depends neither on their order, nor on how often each comes, nor on format and unit.  It finds a
 * scan that was taken from a scanner, a log or a copy, and is sent to be verified.  It does not find
 * points that were moved by some tenths of a millimetre (docs/threat-model.md). */
void digest_scan(const struct cloudpoints *c, char hex[65]);

/* The digests of all scans of a template, in one text: the 64 digits of the first scan, then the first
 * STORE_READ_OTHER digits of each other scan.  "": unknown.
 *
 * digest_read_add(read, digest): Appends the digest of a scan, if there is room. */
void digest_read_add(char read[STORE_READ_MAX + 1], const char *digest);

/* digest_read_has(read, digest): Returns true if digest is one of them. */
bool digest_read_has(const char *read, const char *digest);

#endif
