/* head.h -- a head as points, in the canonical frame (grid.h): the nose tip near the origin,
 * x to the image's right, y up, z away from the face; millimetres.
 * Only for programs: the process exits if out of memory. */
#ifndef SIM_HEAD_H
#define SIM_HEAD_H
#include <stddef.h>
#include <stdint.h>
#include "vec.h"

enum head_part {
    HEAD_SKIN,
    HEAD_COVER, /* glasses, a mask, hair */
    HEAD_VOID   /* hides what is behind it, and gives the scanner nothing */
};

struct head {
    struct dvec3 *at;
    uint8_t *part; /* enum head_part */
    size_t n, cap;
    double spacing; /* mm between points of the skin: 1 / root of their number on a mm2 */
};

#define HEAD_COVER_MM 1.0 /* spacing of what covers the skin */

/* head_alloc(n, size): Returns zeroed memory, to be released by free(). */
void *head_alloc(size_t n, size_t size);

/* head_add(h, p, part): Appends a point; an empty head is all zero. */
void head_add(struct head *h, struct dvec3 p, enum head_part part);

/* head_measure(h): Sets h->spacing, by the number of points near some of them. */
void head_measure(struct head *h);

/* head_move(h, t): Moves all points by t, a row-major 4 x 4 matrix. */
void head_move(struct head *h, const double t[16]);

struct head head_copy(const struct head *h);
void head_free(struct head *h);

/* head_make_up(subject, out): Makes a head from all sides, about 1.8 mm between points: the
 * face is facegen's, on an egg of a skull with a neck; no ears. */
void head_make_up(uint64_t subject, struct head *out);

/* head_add_shoulders(h): Adds shoulders below the neck. */
void head_add_shoulders(struct head *h);

#endif
