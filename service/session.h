/* session.h -- the scan of a request or command: one file, or the frames of one capture session, which are
 * read, fused and judged together (surface_fuse()).
 * The caller sets n, the name of each frame, and its bytes or points.  session_read() then reads the points,
 * and session_build() builds the face. */
#ifndef SERVICE_SESSION_H
#define SERVICE_SESSION_H
#include <stdbool.h>
#include <stddef.h>
#include "cloudfile.h"
#include "cloudpoints.h"
#include "digest.h"
#include "errinfo.h"
#include "inflate.h"
#include "libsurface.h"
#include "sample.h"
#include "status.h"

struct json; /* json.h */

struct session_frame {
    const char *name; /* name of its file, in error texts; borrowed */
    /* Bytes of the file, which lie in session.body; bytes[len] is writable.  NULL: points are set. */
    unsigned char *bytes;
    size_t len;
    enum cloudformat format;    /* format of the file; CLOUDFORMAT_ANY: by its content */
    enum inflate_coding coding; /* compression of the file */
    /* The points as read; after session_build() the points of the face, as from sample_build(). */
    struct cloudpoints points;
    struct sample_found found; /* report on the frame */
    /* ST_OK: the frame was used; else the reason why not. */
    struct errinfo why;
    struct surface_gain
        adds; /* what the frame adds to those before it; place 0: unknown */
};

/* A part of the face that a frame adds, at least SESSION_PART of it. */
#define SESSION_PART 0.25
struct session_part {
    enum surface_region region;
    int side;     /* of the person: -1 right, 1 left, 0 both */
    double share; /* of that part */
};

struct session {
    size_t n; /* number of frames, 1 to SURFACE_FRAMES_MAX */
    /* The client sent a list of files: an unreadable one is left out, and each is reported.  Else there
     * is one frame. */
    bool files;
    struct session_frame frame[SURFACE_FRAMES_MAX];
    unsigned char *body; /* memory of all bytes, by mem_array(), owned; or NULL */
    /* Options of session_read().  The limits hold for all frames together; how.format is not used. */
    struct cloudfile_options how;
    bool axes_given; /* axes=scanner was given; a file may state it too */
    size_t base;     /* index of the frame that receives the points of the fused face */
    struct sample_found
        found; /* report on the base, with the gate's judgement of the fused face */
    const char *digest[SURFACE_FRAMES_MAX]; /* digests of the frames that were read */
    size_t ndigest;                         /* number of these digests */
    char read[STORE_READ_MAX + 1]; /* all these digests, the base's first (digest.h) */
};

/* session_read(s, stop, e): Reads the points of the frames, and frees s->body.  If s->files is set, sets why of
 * the frames that are no scans.
 *   stop  cancellation flag, set by another thread; may be NULL
 * Returns ST_OK; ST_EBUSY: *stop is set; ST_ELIMIT, ST_ESIZE: the frames exceed a limit; or, unless s->files
 * is set, as cloudfile_read(), with ST_EINVAL for its ST_EVERSION. */
enum status session_read(struct session *s, const atomic_bool *stop, struct errinfo *e);

/* session_build(s, o, w, out, e): Builds the face of all frames that were read.  Sets why of the frames that are
 * left out, and s->found.
 * Returns ST_OK; as sample_build(): no frame has a face, or the fused face is refused; ST_EPEOPLE: *e
 * names the frame of another person. */
enum status session_build(struct session *s, const struct sample_options *o,
                          struct surface_work *w, struct surface_face **out,
                          struct errinfo *e);

/* session_points(s): Returns the points of the built face, and their number as read. */
const struct cloudpoints *session_points(const struct session *s);

/* session_parts(g, out): Lists the parts of the face that g adds, and returns their number. */
size_t session_parts(const struct surface_gain *g,
                     struct session_part out[SURFACE_REGIONS]);

/* session_describe(j, s): Writes an array "frames": for each frame its file, whether it was used, the
 * reason if not, and what it adds. */
void session_describe(struct json *j, const struct session *s);

/* session_free(s): Frees the bytes and the points; s is reset to the empty state. */
void session_free(struct session *s);

#endif
