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

struct json_points {
    struct dvec3 *at; /* by mem_free(); NULL: none */
    size_t n;
};

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

/* json_text_wrong(p, at, e): Fills *e: the text at p, byte `at` of the document, is no JSON.  Returns
 * ST_EINVAL. */
enum status json_text_wrong(const char *p, size_t at, struct errinfo *e);

void json_text_free(struct json_text *t); /* the points that are still in it */

#endif
