/* cloudlist.h -- a struct cloudpoints while a reader adds to it.  For cloudfile.c and the
 * readers of each format. */
#ifndef SCAN_CLOUDLIST_H
#define SCAN_CLOUDLIST_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "cloudpoints.h"
#include "cloudvalue.h"
#include "status.h"

struct errinfo; /* errinfo.h */

struct cloudlist {
    struct cloudpoints out;
    size_t max;         /* points that may be kept */
    size_t room;        /* capacity of those arrays of out that exist */
    size_t zeros, zero; /* number of points at (0, 0, 0); index of the first one in out */
    bool kept;          /* the last point was not dropped */
    bool faceless;      /* the faces are not readable: cloudlist_forget() */
    struct errinfo *e;  /* may be NULL */
};

/* cloudlist_room(l, n): Makes the capacity n, if that many points are expected.  To be called at most once, before
 * the first point.  Without it the capacity grows. */
enum status cloudlist_room(struct cloudlist *l, size_t n);

/* cloudlist_add(l, p): Adds the next point of the file, which may be without a value.
 * Returns ST_OK; ST_ELIMIT; ST_ENOMEM; with a message. */
enum status cloudlist_add(struct cloudlist *l, struct dvec3 p);

/* cloudlist_point(l, v, normals): Adds a point by its coordinates, as cloudlist_add(), with its normal.
 *   v        x, y, z; with normals, nx, ny, nz as well, which are unknown unless all three are finite
 *   normals  does not change within a file */
enum status cloudlist_point(struct cloudlist *l, const double v[6], bool normals);

/* A value of each point in binary data. */
struct cloudlist_column {
    const unsigned char *at; /* first point's value */
    uint64_t step;           /* bytes from one point's value to the next one's */
    enum cloudvalue type;
    bool swap; /* cloudvalue_swap() */
};

/* cloudlist_rows(l, c, normals, n): Adds n points by cloudlist_point().
 *   c  a column for each number of a point; all values are within the data */
enum status cloudlist_rows(struct cloudlist *l, const struct cloudlist_column c[6],
                           bool normals, uint64_t n);

/* cloudlist_face(l, corner): Adds a triangle's normal to the normals of its corners.  Corners are numbers of
 * points in the file; if there is no such point, the faces are forgotten (cloudlist_forget()).
 * Returns ST_OK; ST_ENOMEM. */
enum status cloudlist_face(struct cloudlist *l, const uint64_t corner[3]);

/* A polygon while its corners are read; {0} before the first one. */
struct cloudlist_fan {
    uint64_t corner[3], n;
    bool clockwise; /* order of the corners, seen from the front */
};

/* cloudlist_corner(l, f, k): Adds the corner k to the polygon f, and with the third one and each further one
 * a triangle, by cloudlist_face(). */
enum status cloudlist_corner(struct cloudlist *l, struct cloudlist_fan *f, uint64_t k);

/* cloudlist_forget(l): Drops all normals: the faces have turned out not to be readable.  Further faces do
 * nothing. */
void cloudlist_forget(struct cloudlist *l);

/* mm: no camera measures a face from farther away. */
#define CLOUDLIST_RANGE_MM 5000.0

/* cloudlist_finish(l): Ends the list.  Drops those points of an organised cloud whose coordinate stands for "no
 * value", or exceeds the range of cameras.
 * Returns ST_OK; ST_ENOTFINITE: there were points, and none has a value. */
enum status cloudlist_finish(struct cloudlist *l);

#endif
