/* codec.h -- a face model as bytes, and back.  Byte layout: db/FORMAT.md.
 * Little-endian, magic, version, length, checksum; at most 32 bytes a point below 65,536
 * points.  Decoding validates everything: a damaged or hostile block gives ST_ECORRUPT or
 * ST_EVERSION, never a crash. */
#ifndef DB_CODEC_H
#define DB_CODEC_H
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct errinfo;
struct face;
struct face_work;
struct mesh;

size_t codec_size(const struct face *f); /* bytes codec_encode() writes */

/* codec_encode(f, buf): write codec_size(f) bytes. */
void codec_encode(const struct face *f, unsigned char *buf);

/* codec_decode(buf, len, w, out, e): buf need not be aligned.  out as in face_build().
 * Returns ST_OK, ST_ECORRUPT, ST_EVERSION, ST_ENOMEM. */
enum status codec_decode(const void *buf, size_t len, struct face_work *w,
                         struct face *out, struct errinfo *e);

/* codec_digest(m, hex): SHA-256 of the canonical points (FORMAT.md), in lower-case hex:
 * a function of the set of points alone, whatever their order.  O(nv log nv).
 * Returns ST_OK, ST_ENOMEM. */
enum status codec_digest(const struct mesh *m, char hex[65]);

#endif
