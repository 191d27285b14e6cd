/* json.h -- JSON is written and read.  Only this module includes the JSON library.
 *
 * Writing: each call adds a member or an element to the object or array that was begun last, in the order
 * of the calls.  key is NULL for the elements of an array.
 *     struct json *j = json_new();
 *     json_text(j, "subject", id);
 *     json_array(j, "regions");
 *     json_number(j, NULL, mm);
 *     json_close(j);
 *     char *text = json_compact(j);
 * The calls need no checks: if j is NULL or memory has run out they do nothing, and the last one returns
 * NULL.
 * Numbers: each kind of quantity has one function, so that a value has the same digits in the daemon and in
 * the commands.  A number that is not finite becomes null.
 *
 * Reading: json_read() takes a whole document, or reports the error in it and its position.  json_get_*()
 * read its values; they take NULL for a missing value. */
#ifndef BASE_JSON_H
#define BASE_JSON_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct dvec3;
struct errinfo;

#define JSON_DEPTH   16 /* greatest depth of arrays and objects, read or written */
#define JSON_MEMBERS 32 /* greatest number of members of an object that is read */

/* ---- writing */

struct json; /* a document that is being written */

/* json_new(): Returns a document with its outermost object begun; NULL if out of memory. */
struct json *json_new(void);

/* json_object(j, key): Begins an object. */
void json_object(struct json *j, const char *key);

/* json_array(j, key): Begins an array. */
void json_array(struct json *j, const char *key);

/* json_close(j): Ends the object or array that was begun last; never the outermost object. */
void json_close(struct json *j);

/* json_text(j, key, value): Adds a text; NULL: null.  A byte that is not UTF-8 becomes U+FFFD. */
void json_text(struct json *j, const char *key, const char *value);

/* json_text_or_null(j, key, value): Adds a text; "": null. */
void json_text_or_null(struct json *j, const char *key, const char *value);

void json_flag(struct json *j, const char *key, bool value);

/* json_number(j, key, value): Adds a count (exact up to 10^15), a length in mm, an angle in degrees, a time in
 * ms or a share of 1, with up to 4 decimals. */
void json_number(struct json *j, const char *key, double value);

/* json_score(j, key, value): Adds a score with up to 2 decimals. */
void json_score(struct json *j, const char *key, double value);

/* json_extent(j, key, value): Adds an area in mm2 or a volume in mm3 with up to 1 decimal. */
void json_extent(struct json *j, const char *key, double value);

/* json_rate(j, key, value): Adds an error rate with 3 digits. */
void json_rate(struct json *j, const char *key, double value);

/* json_exact(j, key, value): Adds a number with all its digits. */
void json_exact(struct json *j, const char *key, double value);

/* json_direction(j, key, value): Adds a vector of length 1 without a unit, with up to 7 decimals: rounding moves
 * a point at 300 mm by less than 0.0001 mm. */
void json_direction(struct json *j, const char *key, const double value[3]);

/* json_transform(j, key, value): Adds an array of 16 numbers, row by row: the 3 x 3 rotation with the decimals
 * of a direction, the shift, in mm, with those of a length. */
void json_transform(struct json *j, const char *key, const double value[16]);

/* json_similarity(j, key, value, scale): Adds a transform from units of scale mm each to mm.  The decimals of
 * the 3 x 3 part depend on scale, so that a point is mapped as exactly as by json_transform(). */
void json_similarity(struct json *j, const char *key, const double value[16],
                     double scale);

/* json_compact(j): Ends all open objects and releases j.
 * Returns the text on one line without a newline, to be released by free(); NULL if memory ran out, or if
 * the document is deeper than JSON_DEPTH. */
char *json_compact(struct json *j);

/* json_pretty(j): Like json_compact(), but the text is indented. */
char *json_pretty(struct json *j);

/* json_discard(j): Releases a document without a text; NULL is allowed. */
void json_discard(struct json *j);

/* ---- reading */

struct json_value; /* a value of a document that was read */

/* json_read(text, len, max_values, out, e): Reads one document, with nothing after it.
 *   text    text[len] must be 0
 *   out     to be released by json_free(); on failure: NULL
 * Refuses, besides text that is not JSON: bytes that are not UTF-8, \u0000, a control character in a text, an
 * object with two members of one name or more than JSON_MEMBERS members, and arrays and objects deeper than
 * JSON_DEPTH; and more than max_values values, before it allocates memory for them.
 * Cost: O(len); about 80 bytes a value.
 * Returns ST_OK; ST_EINVAL: malformed; ST_ELIMIT: more than max_values; ST_ENOMEM. */
enum status json_read(const char *text, size_t len, size_t max_values,
                      struct json_value **out, struct errinfo *e);

/* json_read_points(text, len, max_values, out, e): Reads a document with the points of clouds, arrays of
 * [x, y, z].  The first two such arrays are read in one pass, without a value in memory for each number: 3,000
 * points take 0.17 ms instead of 1.7.  json_count() and json_get_points() read them like any other array;
 * json_first() does not return these points.
 * Cost: O(len); at most 48 bytes a point, and twice len.
 * Parameters and returns: as json_read(). */
enum status json_read_points(const char *text, size_t len, size_t max_values,
                             struct json_value **out, struct errinfo *e);

/* json_free(document): Releases a document with all its values; NULL is allowed. */
void json_free(struct json_value *document);

bool json_is_array(const struct json_value *v);
bool json_is_null(const struct json_value *v);

/* json_member(object, key): Returns the member; NULL if there is none, or if object is no object. */
const struct json_value *json_member(const struct json_value *object, const char *key);

/* json_expect(v, where, known, e): Checks that v is an object without other members than known: a misspelt
 * member must not be ignored.
 *   where   name of v in the message, "the body"
 *   known   names of the members; ends with NULL
 * Returns ST_OK; ST_EINVAL. */
enum status json_expect(const struct json_value *v, const char *where,
                        const char *const known[], struct errinfo *e);

/* json_first(v): Returns the first value of an array or object; NULL if v has none. */
const struct json_value *json_first(const struct json_value *v);

/* json_next(v): Returns the value after v; NULL after the last one. */
const struct json_value *json_next(const struct json_value *v);

/* json_count(v): Returns the number of values of an array or object; 0 for another value. */
size_t json_count(const struct json_value *v);

/* json_get_text(v): Returns the text, valid as long as the document; NULL if v is no text. */
const char *json_get_text(const struct json_value *v);

/* json_copy_text(v, out, size): Copies the text.  Returns false if v is no text, or has more than size - 1
 * bytes. */
bool json_copy_text(const struct json_value *v, char *out, size_t size);

/* json_get_flag(v, out): Returns false if v is neither true nor false. */
bool json_get_flag(const struct json_value *v, bool *out);

/* json_get_count(v, out): Returns false if v is no whole number from 0 to 2^53. */
bool json_get_count(const struct json_value *v, uint64_t *out);

/* json_get_number(v, out): Returns false if v is no finite number. */
bool json_get_number(const struct json_value *v, double *out);

/* json_get_points(v, out, n): Reads an array of points.
 *   out     buffer of json_count(v) points
 *   n       number of points read
 * Returns ST_OK; ST_EINVAL: element *n is no point, or v is no array; ST_ENOTFINITE: a number of element *n
 * is too large for a double. */
enum status json_get_points(const struct json_value *v, struct dvec3 *out, size_t *n);

#endif
