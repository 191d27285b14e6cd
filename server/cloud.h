/* cloud.h -- from the body of a request to a face model. */
#ifndef SERVER_CLOUD_H
#define SERVER_CLOUD_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct errinfo;
struct face;
struct face_work;
struct request;

struct cloud {
    struct dvec3 *pts; /* mm, in the order they came; released by cloud_free() */
    size_t n;
    double unit_mm; /* millimetres per unit that they were sent in */
};

/* cloud_read(r, out): the body as JSON or as a scanner's file, in millimetres; for JSON its
 * own "units" wins over ?units=.  The body is released.  Returns ST_OK, or another status
 * with r->response set. */
enum status cloud_read(struct request *r, struct cloud *out);

/* cloud_read_two(r, a, b): the body {"a": cloud, "b": cloud}, the same. */
enum status cloud_read_two(struct request *r, struct cloud *a, struct cloud *b);

/* cloud_build(r, c, name, w, out): the model; name is "points", "a.points" or "b.points".
 * Returns ST_OK, or another status with r->response set. */
enum status cloud_build(struct request *r, const struct cloud *c, const char *name,
                        struct face_work *w, struct face *out);

void cloud_free(struct cloud *c); /* c is empty again */

#endif
