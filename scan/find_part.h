/* find_part.h -- the connected parts of a cloud: a person before a wall, several people, an
 * object on a table.  Internal to find.h. */
#ifndef SCAN_FIND_PART_H
#define SCAN_FIND_PART_H
#include <stdint.h>
#include "find_grid.h"
#include "status.h"

#define FIND_PARTS 6

/* find_part_all(g, parts, n): those of g of a head's size (FIND_HEAD_MIN_MM to
 * FIND_ROOM_MIN_MM) with FIND_PART_POINTS at least, at most FIND_PARTS: those with the most
 * points, each as a grid of its own with g's corner.  Connected are cells that touch.
 * Linear in the cells.  Returns ST_OK, ST_ENOMEM; parts are to be freed after ST_OK alone. */
enum status find_part_all(const struct find_grid *g, struct find_grid parts[FIND_PARTS],
                          uint32_t *n);

#endif
