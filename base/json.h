/* json.h -- JSON written and read; the one place that knows the JSON library.
 *
 * Writing: each call adds a member or element to the object or array begun last, in the
 * order of the calls; key is NULL for the elements of an array.
 *     struct json *j = json_new();
 *     json_text(j, "subject", id);
 *     json_array(j, "regions");
 *     json_number(j, NULL, mm);
 *     json_close(j);
 *     char *text = json_compact(j);
 * The calls need no checks: once memory ran out, or where j is NULL, they do nothing, and
 * the last returns NULL.
 * Numbers: each kind of quantity has one function, so that the same value has the same
 * digits in the daemon and in the command.  What is not finite becomes null.
 *
 * Reading: json_read() takes a whole document or says what is wrong with it and where;
 * json_get_*() then read its values.  They take NULL for a value that is missing. */
#ifndef BASE_JSON_H
#define BASE_JSON_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct dvec3;
struct errinfo;

#define JSON_DEPTH   16 /* arrays and objects within each other, read or written */
#define JSON_MEMBERS 32 /* of an object that is read */

/* ---- writing */

struct json; /* a document that is being written */

struct json *json_new(void); /* with its outermost object begun; NULL: no memory */
void json_object(struct json *j, const char *key);
void json_array(struct json *j, const char *key);
void json_close(struct json *j); /* the object or array begun last; not the outermost */

/* A text; NULL: null.  A byte that is not UTF-8 becomes U+FFFD. */
void json_text(struct json *j, const char *key, const char *value);
void json_flag(struct json *j, const char *key, bool value);

/* A count (exact up to 10^15), a length in mm, an angle in degrees, a time in ms, a share of
 * 1: at most 4 decimals. */
void json_number(struct json *j, const char *key, double value);
void json_score(struct json *j, const char *key, double value);  /* 2 decimals */
void json_extent(struct json *j, const char *key, double value); /* mm2, mm3: 1 decimal */
void json_rate(struct json *j, const char *key, double value);  /* error rate: 3 digits */
void json_exact(struct json *j, const char *key, double value); /* all its digits */

/* A vector without a unit, of length 1: 7 decimals each, which move a point 300 mm away
 * by less than 0.0001 mm. */
void json_direction(struct json *j, const char *key, const double value[3]);

/* An array of 16, row by row: the 3 x 3 in front has the decimals of a direction, what it
 * moves by, in mm, those of a length. */
void json_transform(struct json *j, const char *key, const double value[16]);

/* json_similarity(j, key, value, scale): the same for a transform from units of scale mm each
 * to mm: with scale the decimals of the 3 x 3 change, so that a point is mapped as exactly. */
void json_similarity(struct json *j, const char *key, const double value[16],
                     double scale);

/* The text, on one line or indented, without a newline at its end; heap, for free().
 * NULL: out of memory on the way, or deeper than JSON_DEPTH.  Objects still open are
 * closed.  j is released. */
char *json_compact(struct json *j);
char *json_pretty(struct json *j);

void json_discard(struct json *j); /* release it without a text; NULL is allowed */

/* ---- reading */

struct json_value; /* a value of a document that was read */

/* json_read(text, len, max_values, out, e): one document and nothing behind it.
 * text[len] must be 0.  Refused, besides what is not JSON: bytes that are not UTF-8,
 * \u0000, a control character in a text, an object with two members of one name or more
 * than JSON_MEMBERS, and arrays and objects deeper than JSON_DEPTH; and, before memory is
 * taken for them, more than max_values values.
 * Returns ST_OK, *out released by json_free(); ST_EINVAL malformed; ST_ELIMIT more than
 * max_values; ST_ENOMEM.  On failure *out is NULL.
 * Memory: some 80 bytes a value.  O(len). */
enum status json_read(const char *text, size_t len, size_t max_values,
                      struct json_value **out, struct errinfo *e);

/* json_read_points(...): as json_read(), for documents with the points of clouds, arrays of
 * [x, y, z].  The first two of them are read in one pass, without a value in memory for
 * each number: json_count() and json_get_points() read them as any other array, while
 * json_first() does not give the points.
 * Memory: at most 48 bytes a point of theirs and twice len; O(len). */
enum status json_read_points(const char *text, size_t len, size_t max_values,
                             struct json_value **out, struct errinfo *e);

void json_free(struct json_value *document); /* with all its values; NULL is allowed */

bool json_is_object(const struct json_value *v);
bool json_is_array(const struct json_value *v);
bool json_is_null(const struct json_value *v);

/* json_member(object, key): NULL: there is none, or it is no object. */
const struct json_value *json_member(const struct json_value *object, const char *key);

/* json_expect(v, where, known, e): v must be an object without other members than known,
 * which ends with NULL: one that is misspelt must not be ignored.  where: what to call
 * it, "the body".  Returns ST_OK, ST_EINVAL. */
enum status json_expect(const struct json_value *v, const char *where,
                        const char *const known[], struct errinfo *e);

/* json_first(v), json_next(v): the values of an array or object in their order; NULL
 * after the last.  json_key(v): the name of a member; valid as long as the document. */
const struct json_value *json_first(const struct json_value *v);
const struct json_value *json_next(const struct json_value *v);
const char *json_key(const struct json_value *v);

/* What a value is; false, or NULL, where it is of another type or missing.
 * json_get_text(v): valid as long as the document.
 * json_copy_text(v, out, size): false too where it has more than size - 1 bytes.
 * json_get_count(v, out): a whole number, 0 to 2^53.
 * json_get_number(v, out): a finite number.
 * json_count(v): the values of an array or object.
 * json_get_points(v, out, n): an array of points into out, which has room for
 * json_count(v).  Returns ST_OK; ST_EINVAL the element *n, or v itself, is something else;
 * ST_ENOTFINITE a number of the element *n is too large for a double. */
const char *json_get_text(const struct json_value *v);
bool json_copy_text(const struct json_value *v, char *out, size_t size);
bool json_get_flag(const struct json_value *v, bool *out);
bool json_get_count(const struct json_value *v, uint64_t *out);
bool json_get_number(const struct json_value *v, double *out);
size_t json_count(const struct json_value *v);
enum status json_get_points(const struct json_value *v, struct dvec3 *out, size_t *n);

#endif
