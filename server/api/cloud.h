/* cloud.h -- from the body of a request to a face model. */
#ifndef SERVER_CLOUD_H
#define SERVER_CLOUD_H
#include <stdbool.h>
#include "cloudfile.h"
#include "cloudpoints.h"
#include "status.h"

struct errinfo;
struct surface_face;
struct surface_work;
struct multipart_file; /* multipart.h */
struct request;
struct sample_found; /* sample.h */

/* cloud_options(r, o, axes_given): how r's clouds are to be read, by its parameters and limits;
 * axes_given: axes=scanner.  False: r->response says what is wrong with them. */
bool cloud_options(struct request *r, struct cloudfile_options *o, bool *axes_given);

/* cloud_read(r, out): the body as JSON or as a scanner's file; a unit of the file's own wins
 * over ?units=, and axes over ?axes=auto.  The body is released.
 * out: by cloudpoints_free().  Returns ST_OK, or another status with r->response set. */
enum status cloud_read(struct request *r, struct cloudpoints *out);

/* cloud_take(r, out, e): the same, but r->response is set only for a parameter; *e has
 * everything else. */
enum status cloud_take(struct request *r, struct cloudpoints *out, struct errinfo *e);

/* cloud_read_file(g, f, out, e): a file of r's form, packed or not; of what the files may have
 * together, g->o has what is left: begin with cloud_options().  Also ST_ELIMIT, ST_ESIZE. */
struct cloud_reading {
    struct request *r;
    struct cloudfile_options o; /* max_points, max_bytes: what is left of them */
    bool axes_given;
};
enum status cloud_read_file(struct cloud_reading *g, const struct multipart_file *f,
                            struct cloudpoints *out, struct errinfo *e);

/* cloud_read_two(r, a, b): the body {"a": cloud, "b": cloud}, or a form with the files a and b,
 * the same. */
enum status cloud_read_two(struct request *r, struct cloudpoints *a,
                           struct cloudpoints *b);

/* cloud_build(r, c, name, enrolment, w, out, found): the model; c then has the points used, in mm
 * (sample.h).  name is "points", "a.points" or "b.points".
 * Returns ST_OK, or another status with r->response set. */
enum status cloud_build(struct request *r, struct cloudpoints *c, const char *name,
                        bool enrolment, struct surface_work *w, struct surface_face **out,
                        struct sample_found *found);

#endif
