/* sample.h -- from the points of a scan to a face model, or the reason why there is none:
 * what was measured, and what to do. */
#ifndef SERVICE_SAMPLE_H
#define SERVICE_SAMPLE_H
#include <stdatomic.h>
#include <stdbool.h>
#include "cloudformat.h"
#include "libsurface.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct errinfo;     /* errinfo.h */

struct sample_options {
    bool frontal;   /* or the file says so: its axes are as SURFACE_FRONTAL has them */
    bool enrolment; /* by the strict gate */
    const atomic_bool *stop; /* another thread sets it to stop the work; may be NULL */
};

/* What a file said, and what was found in it. */
struct sample_found {
    enum cloudformat format;
    size_t points_read, points_dropped; /* dropped: without a value */
    struct surface_found scan;
    char digest[65]; /* of the set of points as they were read; "" of a dry run */
};

/* sample_build(name, c, o, w, out, found, e): surface_build() of the points that a reader left.
 * name  a file's, or "points" of a request: the text begins with it, and ends with the advice
 *       (advice.h)
 * c     afterwards the points of the face, with their places; to be freed, also on failure
 * Returns as it does; *e is set on failure. */
enum status sample_build(const char *name, struct cloudpoints *c,
                         const struct sample_options *o, struct surface_work *w,
                         struct surface_face **out, struct sample_found *found,
                         struct errinfo *e);

/* For other ways to build: the found of c before the build; c for the library, which
 * borrows *stop; the reason of a refusal. */
struct sample_found sample_begin(const struct cloudpoints *c);
struct surface_stop sample_stop(const struct sample_options *o);
struct surface_cloud sample_cloud(const struct cloudpoints *c,
                                  const struct sample_options *o,
                                  const struct surface_stop *stop);
/* sample_open(c, o, stop, cloud, found): c for a build that leaves its face's points in it, and found
 * with the digest.  False: no memory.
 * sample_close(c, found): after that build, found->scan of which is set. */
bool sample_open(struct cloudpoints *c, const struct sample_options *o,
                 const struct surface_stop *stop, struct surface_cloud *cloud,
                 struct sample_found *found);
void sample_close(struct cloudpoints *c, struct sample_found *found);

/* sample_tell(c, found): Sets in found what the library does not know of c: whether its unit was given,
 * and, of a depth image, found->fits_mm for a value of the image. */
void sample_tell(const struct cloudpoints *c, struct surface_found *found);
void sample_refuse(const char *name, enum status st, const struct sample_found *found,
                   struct errinfo *e);

#endif
