/* sample.h -- from the points of a scan to a face model, with the reason where there is
 * none: what was measured, and what to do. */
#ifndef VERIFY_SAMPLE_H
#define VERIFY_SAMPLE_H
#include "scan.h"
#include "status.h"

struct errinfo; /* errinfo.h */

/* sample_build(name, c, o, w, out, found, e): scan_build(), with the axes of o or of the file
 * itself.  name: a file's, or "points" of a request: the text begins with it, and ends with the
 * advice (advice.h).  out->quality.density_mm is 0 where the quality was not rated.
 * Returns as it does; *e is set on failure. */
enum status sample_build(const char *name, struct cloudpoints *c,
                         const struct scan_options *o, struct face_work *w,
                         struct face *out, struct scan_found *found, struct errinfo *e);

#endif
