/* sample.h -- from the points of a scan to a face model, with the reason where there is
 * none: what was measured, and what to do. */
#ifndef VERIFY_SAMPLE_H
#define VERIFY_SAMPLE_H
#include <stddef.h>
#include "status.h"
#include "vec.h"

struct errinfo;   /* errinfo.h */
struct face;      /* face.h */
struct face_work; /* face.h */

struct sample {
    const char *name; /* a file's, or "points" of a request: the text begins with it */
    const struct dvec3 *pts; /* mm, in the order they came */
    size_t n;
    double unit_mm; /* millimetres per unit that they were given in */
};

/* sample_build(s, w, out, e): face_build().  Returns as it does; *e is set on failure. */
enum status sample_build(const struct sample *s, struct face_work *w, struct face *out,
                         struct errinfo *e);

#endif
