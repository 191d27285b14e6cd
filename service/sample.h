/* sample.h -- from the points of a scan to a face model, or to a refusal: its reason, the measurements,
 * and advice. */
#ifndef SERVICE_SAMPLE_H
#define SERVICE_SAMPLE_H
#include <stdatomic.h>
#include <stdbool.h>
#include "cloudformat.h"
#include "libsurface.h"
#include "rows_types.h"
#include "status.h"

struct cloudpoints; /* cloudpoints.h */
struct errinfo;     /* errinfo.h */

struct sample_options {
    bool enrolment;          /* the strict gate applies */
    const atomic_bool *stop; /* cancellation flag, set by another thread; may be NULL */
};

/* The report on a scan: its format, its points, the findings of the library. */
struct sample_found {
    enum cloudformat format;
    size_t points_read, points_dropped; /* numbers of points; dropped: without a value */
    struct surface_found scan;          /* findings of surface_build() */
    char digest[65]; /* digest of the set of points as read; "" in a dry run */
};

/* sample_build(name, c, o, w, out, found, e): Runs surface_build() on the points that a reader has read.
 *   name  of a file, or "points" of a request; the error text begins with it, and ends with the advice
 *         (advice.h)
 *   c     receives the points of the face, with their places; to be freed, also after a failure
 * Returns as surface_build(); *e is set on failure. */
enum status sample_build(const char *name, struct cloudpoints *c,
                         const struct sample_options *o, struct surface_work *w,
                         struct surface_face **out, struct sample_found *found,
                         struct errinfo *e);

/* ---- the parts of sample_build(), for other ways to build a face */

/* sample_begin(c): Returns the report on c before the build: format and numbers of points. */
struct sample_found sample_begin(const struct cloudpoints *c);

/* sample_not_stopped(stop, e): Returns ST_OK; ST_EBUSY: *stop is set.  NULL: it never is. */
enum status sample_not_stopped(const atomic_bool *stop, struct errinfo *e);

/* sample_counted(face): Returns what the day's counts take of a scan (store_scans()). */
struct store_scan sample_counted(const struct surface_face *face);

/* sample_stop(o): Returns the cancellation flag of o, for the library. */
struct surface_stop sample_stop(const struct sample_options *o);

/* sample_cloud(c, o, stop): Returns c as a cloud of the library, which borrows c and *stop. */
struct surface_cloud sample_cloud(const struct cloudpoints *c,
                                  const struct sample_options *o,
                                  const struct surface_stop *stop);

/* sample_open(c, o, stop, cloud, found): Prepares a build that writes the points of the face to c: sets *cloud as
 * sample_cloud(), and *found as sample_begin(), with the digest.  Returns false if out of memory. */
bool sample_open(struct cloudpoints *c, const struct sample_options *o,
                 const struct surface_stop *stop, struct surface_cloud *cloud,
                 struct sample_found *found);

/* sample_close(c, found): Ends the build that sample_open() has prepared: c then has the points of the face.
 *   found  its member scan is set by the build */
void sample_close(struct cloudpoints *c, struct sample_found *found);

/* sample_tell(c, found): Sets the members of *found that the library cannot know: whether the unit of c was
 * detected, and, for a depth image, fits_mm for a value of the image. */
void sample_tell(const struct cloudpoints *c, struct surface_found *found);

/* sample_refuse(name, st, found, e): Fills *e with st, the reason of the refusal, and the advice.  name as in
 * sample_build(). */
void sample_refuse(const char *name, enum status st, const struct sample_found *found,
                   struct errinfo *e);

#endif
