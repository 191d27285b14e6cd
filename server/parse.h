/* parse.h -- the JSON that a request's body is: clouds, a subject to be made, what to
 * change of one.  What is wrong with it and where stands in e. */
#ifndef SERVER_PARSE_H
#define SERVER_PARSE_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"
#include "store.h"
#include "vec.h"

struct errinfo;

struct parse_cloud {
    struct dvec3 *pts; /* in their own unit; released by mem_free() */
    size_t n;
    double mm;      /* millimetres per unit */
    bool has_units; /* false: units was not given, and mm is 1 */
};

/* parse_cloud(text, len, max_points, out, e): {"points": [[x,y,z],...], "units": "mm"}.
 * text  text[len] must be 0.
 * Strict where it matters: one document and nothing behind it, valid UTF-8, no key twice,
 * three finite numbers a point, no other members.  e tells what and where.
 * Memory: at most 75 bytes a point while it reads, and 80 a value behind one that is not a
 * point; refused before that when there are more values than max_points can need.
 * Returns ST_OK; ST_EINVAL malformed; ST_ENOTFINITE a number too large for a double;
 * ST_ELIMIT more than max_points; ST_ENOMEM.  On failure out is empty. */
enum status parse_cloud(const char *text, size_t len, size_t max_points,
                        struct parse_cloud *out, struct errinfo *e);

/* parse_clouds(..., a, b, e): {"a": cloud, "b": cloud}, the same. */
enum status parse_clouds(const char *text, size_t len, size_t max_points,
                         struct parse_cloud *a, struct parse_cloud *b, struct errinfo *e);

/* parse_units(name, mm): "mm", "cm", "m" to millimetres per unit; false: none of them. */
bool parse_units(const char *name, double *mm);

#define PARSE_TEXT_MAX 256

struct parse_change {
    struct store_subject_change what; /* points into the rest, which is not to be moved */
    char consent[PARSE_TEXT_MAX], purpose[PARSE_TEXT_MAX], expires[PARSE_TEXT_MAX];
    bool hold, disabled;
};

/* parse_newcomer(text, len, out, e): a subject to be made: its id as subject, and
 * consent, purpose and expires_at, which may miss or be null; the rest as below. */
enum status parse_newcomer(const char *text, size_t len, struct store_subject *out,
                           struct errinfo *e);

/* parse_change(text, len, out, e): a merge patch (RFC 7396) of a subject: consent,
 * purpose, expires_at (texts, or null for none), hold and disabled.  text as above.
 * Nothing else may be in it: who means to hold is not to find out later that "on_hold"
 * did nothing.  Returns ST_OK; ST_EINVAL; ST_ENOMEM. */
enum status parse_change(const char *text, size_t len, struct parse_change *out,
                         struct errinfo *e);

#endif
