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
    const char *name; /* name of its file; borrowed */
    /* The points as read; after session_build() the points of the face, as from sample_build(). */
    struct cloudpoints points;
    struct sample_found found; /* report on the frame */
    /* ST_OK: the frame was fused; else the reason why not.  The caller sets it if it cannot read the
     * frame. */
    struct errinfo why;
};

struct session {
    size_t n; /* number of frames, 1 to SURFACE_FRAMES_MAX */
    struct session_frame frame[SURFACE_FRAMES_MAX];
    size_t base; /* index of the frame that receives the points of the fused face */
    const char *digest[SURFACE_FRAMES_MAX]; /* digests of the frames that were read */
    size_t ndigest;                         /* number of these digests */
    char read[STORE_READ_MAX + 1]; /* all these digests, the base's first (digest.h) */
};

/* session_build(s, o, w, out, found, e): Builds the face of all frames that were read.  Sets why of the frames
 * that are left out.
 *   found  receives the report on the base, with the gate's judgement of the fused face
 * Returns ST_OK; as sample_build(): no frame has a face, or the fused face is refused; ST_EPEOPLE: *e
 * names the frame of another person. */
enum status session_build(struct session *s, const struct sample_options *o,
                          struct surface_work *w, struct surface_face **out,
                          struct sample_found *found, struct errinfo *e);

/* session_describe(j, s): Writes an array "frames": for each frame its file, whether it was used, and the
 * reason if not. */
void session_describe(struct json *j, const struct session *s);

/* session_free(s): Frees the points; s is reset to the empty state. */
void session_free(struct session *s);

#endif
