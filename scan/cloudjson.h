/* cloudjson.h -- a cloud as JSON: {"points": [[x,y,z], ...], "units": "mm", "axes": "auto"}. */
#ifndef SCAN_CLOUDJSON_H
#define SCAN_CLOUDJSON_H
#include <stddef.h>
#include "status.h"

struct cloudlist;  /* cloudlist.h */
struct errinfo;    /* errinfo.h */
struct json_value; /* json.h */

/* cloudjson_document(text, len, max_points, clouds, out, e): a document with room for so
 * many clouds; text[len] is 0; *out is released by json_free().  Strict: one document and
 * nothing behind it, valid UTF-8, no key twice.
 * Memory: at most 75 bytes a point, and 80 a value behind one that is not a point; refused
 * before that when there are more values than the points can need.
 * Returns ST_OK; ST_EINVAL; ST_ELIMIT; ST_ENOMEM. */
enum status cloudjson_document(const char *text, size_t len, size_t max_points,
                               size_t clouds, struct json_value **out, struct errinfo *e);

/* cloudjson_take(object, name, prefix, list): its points, its unit and its axes: three finite
 * numbers each, and no other members than points, units and axes.  name: what to call the object, "the
 * body"; prefix: "" or "a.", before the names of its members.
 * Returns ST_OK; ST_EINVAL; ST_ENOTFINITE a number too large for a double; ST_ELIMIT; ST_ENOMEM; the
 * message is in list->e. */
enum status cloudjson_take(const struct json_value *object, const char *name,
                           const char *prefix, struct cloudlist *list);

#endif
