/* json_points.h -- the points of a cloud in the text of a JSON document, read without a
 * value in memory for each number.  For json.c. */
#ifndef BASE_JSON_POINTS_H
#define BASE_JSON_POINTS_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct json_points {
    struct dvec3 *at; /* by mem_free(); NULL: none */
    size_t n;
};

/* json_points_number(p): does a number begin at p as RFC 8259, section 6, writes one, up to
 * its exponent?  p is in a text that ends with 0. */
bool json_points_number(const char *p);

/* json_points_read(p, end, max, out, rest): the points at the front of the array whose
 * first byte after the bracket is p: [x, y, z] of three finite numbers each.
 * rest  where the array's remainder begins, which is for the parser: its closing bracket
 *       if all of it was points; else the last of the points that came before something
 *       else, which is not in out: a parser that finds an error there finds it at the byte
 *       where it is in the whole document.
 * end   of the text; *end is 0
 * Numbers are correctly rounded in every locale.  Memory: at most 48 bytes a point, and no
 * less than 1.5 KB.  O(bytes read).
 * Returns ST_OK; ST_ELIMIT more than max points; ST_ENOMEM.  On failure out is empty. */
enum status json_points_read(const char *p, const char *end, size_t max,
                             struct json_points *out, const char **rest);

#endif
