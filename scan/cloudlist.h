/* cloudlist.h -- a struct cloudpoints while a reader adds to it.  For cloudfile.c and the
 * readers of each format. */
#ifndef SCAN_CLOUDLIST_H
#define SCAN_CLOUDLIST_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "cloudpoints.h"
#include "status.h"

struct errinfo; /* errinfo.h */

struct cloudlist {
    struct cloudpoints out;
    size_t max;         /* points that may be kept */
    size_t room;        /* of the arrays of out that are there */
    size_t zeros, zero; /* points at (0, 0, 0); where the first of them is in out */
    bool kept;          /* the last point was not dropped */
    struct errinfo *e;  /* may be NULL */
};

/* cloudlist_room(l, n): n points will be added, or fewer; to be called at most once, first.
 * Without it the room grows. */
enum status cloudlist_room(struct cloudlist *l, size_t n);

/* cloudlist_add(l, p): the next point of the file, which may be without a value.
 * Returns ST_OK, ST_ELIMIT, ST_ENOMEM, with a message. */
enum status cloudlist_add(struct cloudlist *l, struct dvec3 p);

/* cloudlist_normal(l, n): the normal of the point added last; what is not finite counts as
 * unknown.  Once called, it is called for every point.  Returns ST_OK, ST_ENOMEM. */
enum status cloudlist_normal(struct cloudlist *l, struct dvec3 n);

/* cloudlist_face(l, corner): a triangle, of points by their numbers in the file.  Returns
 * ST_OK; ST_EINVAL there is no such point (no message); ST_ENOMEM. */
enum status cloudlist_face(struct cloudlist *l, const uint64_t corner[3]);

/* cloudlist_forget(l): the faces have turned out not to be readable: no normals. */
void cloudlist_forget(struct cloudlist *l);

/* mm: no camera measures a face from farther away. */
#define CLOUDLIST_RANGE_MM 5000.0

/* cloudlist_finish(l): all are added.  Of an organised cloud the points whose coordinate stands for "no
 * value", or is beyond the range of cameras, are dropped.  Returns ST_OK; ST_ENOTFINITE there were points, and
 * none has a value. */
enum status cloudlist_finish(struct cloudlist *l);

#endif
