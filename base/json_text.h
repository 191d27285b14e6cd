/* json_text.h -- the text of a JSON document before the library reads it.  It is checked for what the library
 * accepts wrongly, or refuses only after it has allocated memory, and the points of clouds are cut out of it,
 * which then need no value each.  Only json.c includes this header. */
#ifndef BASE_JSON_TEXT_H
#define BASE_JSON_TEXT_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct errinfo;

struct json_points {
    struct dvec3 *at; /* [n], to be released by mem_free(); NULL: none */
    size_t n;
};

#define JSON_TEXT_CUTS 2 /* {"a": cloud, "b": cloud} */

struct json_text_cut {
    size_t array;   /* number of arrays that begin before the one with the points */
    size_t at, len; /* first byte and number of bytes that are cut out */
    struct json_points points;
};

struct json_text {
    const char *
        bytes; /* [len + 1], ends with 0; set by the caller, like the next three members */
    size_t len, max_values, max_depth;
    size_t max_cuts; /* at most JSON_TEXT_CUTS */

    size_t cuts; /* set by json_text_check(), like the following members */
    struct json_text_cut cut[JSON_TEXT_CUTS];
    size_t values, arrays;
};

/* json_text_check(t, e): Checks the text by the rules of json_read(), except that the library checks the JSON
 * that remains and this module's caller the members of objects; cuts out the points.
 *   t       to be released by json_text_free()
 * Returns ST_OK; ST_EINVAL; ST_ELIMIT; ST_ENOMEM. */
enum status json_text_check(struct json_text *t, struct errinfo *e);

/* json_text_rest(t, len): Returns the text without the points, to be released by mem_free(); NULL if out of
 * memory.  An array of points is empty in it, unless it has other elements. */
char *json_text_rest(const struct json_text *t, size_t *len);

/* json_text_place(t, at): Returns the position in the document of byte `at` of the rest. */
size_t json_text_place(const struct json_text *t, size_t at);

/* json_text_wrong(p, at, e): Fills *e: the text at p, byte `at` of the document, is not JSON.  Returns
 * ST_EINVAL. */
enum status json_text_wrong(const char *p, size_t at, struct errinfo *e);

/* json_text_free(t): Releases the points that are still in t. */
void json_text_free(struct json_text *t);

#endif
