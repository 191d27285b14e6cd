/* json_text.h -- the text of a JSON document before the library reads it: checked for what
 * the library accepts although it should not, or refuses only after it took memory for it,
 * and without the points of clouds, which need no value each.  For json.c. */
#ifndef BASE_JSON_TEXT_H
#define BASE_JSON_TEXT_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct errinfo;

/* The points of a cloud in the text of a JSON document, read without a
 * value in memory for each number.  For json.c. */

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

#define JSON_TEXT_CUTS 2 /* {"a": cloud, "b": cloud} */

struct json_text_cut {
    /* how many arrays of the document begin before the one with the points */
    size_t array;
    size_t at; /* the first byte that is left out */
    size_t len;
    struct json_points points;
};

struct json_text {
    const char *bytes; /* bytes[len] is 0 */
    size_t len, max_values, max_depth;
    size_t max_cuts; /* at most JSON_TEXT_CUTS */
    size_t cuts;     /* this and what follows is set by json_text_check() */
    struct json_text_cut cut[JSON_TEXT_CUTS];
    size_t values, arrays;
};

/* json_text_check(t, e): set the first five members, and the rest to zero.  As json_read()
 * says; what is left to the library is whether the rest is JSON, and the members of its
 * objects.  Returns ST_OK, ST_EINVAL, ST_ELIMIT, ST_ENOMEM. */
enum status json_text_check(struct json_text *t, struct errinfo *e);

/* json_text_rest(t, len): the text without what was cut out of it, for mem_free(); NULL: no
 * memory.  An array of points is empty there, unless there is more in it. */
char *json_text_rest(const struct json_text *t, size_t *len);

/* json_text_place(t, at): where in the document a byte of the rest is. */
size_t json_text_place(const struct json_text *t, size_t at);

void json_text_free(struct json_text *t); /* the points that are still in it */

#endif
