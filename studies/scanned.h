/* scanned.h -- a scan as delivered, what the program makes of it, and both as pictures. */
#ifndef STUDIES_SCANNED_H
#define STUDIES_SCANNED_H
#include <stdbool.h>
#include <stddef.h>
#include "cloudpoints.h"
#include "face.h"
#include "scan.h"

struct head;     /* head.h */
struct headscan; /* headscan.h */
struct lab;      /* lab.h */

struct scanned {
    unsigned reason; /* of a refusal: scanned_reason(); 0: none */
    struct face face;
    struct scan_found found;
};

#define SCANNED_REASONS 8
const char *scanned_reason(unsigned k); /* "no face", ...; static */

/* scanned_build(c, unit_mm, o, w, out): scan_build() of a copy of c, in a unit that is told, or
 * 0; scanned_free(). */
void scanned_build(const struct cloudpoints *c, double unit_mm,
                   const struct scan_options *o, struct face_work *w,
                   struct scanned *out);
void scanned_free(struct scanned *s);

/* scanned_cloud(s, out): as cloudfile_read() would have it; cloudpoints_free(). */
void scanned_cloud(const struct headscan *s, struct cloudpoints *out);

/* scanned_stand(p, n, crop, w, out): headpose_find(), and the head in its canonical frame, out;
 * head_free().  False where no face was found: out is empty. */
bool scanned_stand(const struct dvec3 *p, size_t n, bool crop, struct face_work *w,
                   struct head *out);

/* scanned_draw(lab, source, name, c, s): SOURCE_NAME_raw.dat, the points as the file has them,
 * its z towards the eye, by depth; and SOURCE_NAME_face.dat, the face that was made of them,
 * shaded; empty where there is none. */
void scanned_draw(const struct lab *lab, const char *source, const char *name,
                  const struct cloudpoints *c, const struct scanned *s);

#endif
