/* session.h -- the frames of one capture session as one sample: read, fused and judged together
 * (surface_fuse()). */
#ifndef SERVICE_SESSION_H
#define SERVICE_SESSION_H
#include <stddef.h>
#include "cloudpoints.h"
#include "digest.h"
#include "errinfo.h"
#include "libsurface.h"
#include "sample.h"
#include "status.h"

struct json; /* json.h */

struct session_frame {
    const char *name; /* of its file; borrowed */
    struct cloudpoints
        points; /* as they were read; then those of its face, as sample_build() has
                                  them */
    struct sample_found found;
    struct errinfo
        why; /* ST_OK: it was fused, or why not; set before where it was not read */
};

struct session {
    size_t n; /* 1..SURFACE_FRAMES_MAX */
    struct session_frame frame[SURFACE_FRAMES_MAX];
    size_t
        base; /* the frame whose points are, after session_build(), those of the fused face */
    const char *digest[SURFACE_FRAMES_MAX]; /* of each frame that was read; [ndigest] */
    size_t ndigest;
    char read[STORE_READ_MAX + 1]; /* those of all, the base's first (digest.h) */
};

/* session_build(s, o, w, out, found, e): the face of all frames that were read, and why the others
 * are left out.
 * found  what was found in the base, with the gate's judgement of the fused face
 * Returns ST_OK; as sample_build(): no frame has a face, or the fused one is refused; ST_EPEOPLE:
 * *e names the frame of another person. */
enum status session_build(struct session *s, const struct sample_options *o,
                          struct surface_work *w, struct surface_face **out,
                          struct sample_found *found, struct errinfo *e);

/* session_describe(j, s): an array "frames": of each the file, whether it was used, or the reason. */
void session_describe(struct json *j, const struct session *s);

void session_free(struct session *s); /* the points; s is empty again */

#endif
