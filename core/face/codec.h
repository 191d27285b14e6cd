/* codec.h -- a face from bytes; surface_encode() writes them.  Byte layout: db/FORMAT.md.
 * Little-endian, magic, version, length; at most 32 bytes a point below 65,536 points.
 * Decoding verifies everything: a damaged or hostile block gives ST_ECORRUPT or ST_EVERSION,
 * never a crash.  There is no checksum: the caller authenticates stored bytes. */
#ifndef CORE_CODEC_H
#define CORE_CODEC_H
#include <stddef.h>
#include "status.h"

struct surface_face; /* face.h */
struct surface_work; /* face.h */

/* codec_decode(buf, len, w, out): Decodes a face, or its head alone: the face then has no surface.
 *   buf  need not be aligned
 *   out  as in face_build(); its quality is zero.  On failure, and without a surface, out->surface.mesh.nv is 0
 * Returns ST_OK; ST_ECORRUPT; ST_ENOMEM; ST_EVERSION, also for the head of another model's face. */
enum status codec_decode(const void *buf, size_t len, struct surface_work *w,
                         struct surface_face *out);

#endif
