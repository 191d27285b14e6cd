/* faces.h -- faces of generated scans, and the working memory of a test program: one for the whole
 * program, so that its reuse is tested throughout.  It exists from before the program's BEFORE_ALL
 * until after its AFTER_ALL.  A failure here fails the calling test. */
#ifndef TESTS_FACES_H
#define TESTS_FACES_H
#include <stddef.h>
#include <stdint.h>
#include "face.h"

#define FACES_POINTS 3000

extern struct surface_work *faces_work;
extern struct dvec3 faces_pts[2 * FACES_POINTS]; /* points of the last faces_scan() */
extern size_t faces_n;                           /* number of these points */

/* faces_scan(subject, scan, n): Sets faces_pts to a frontal scan of n points or fewer. */
void faces_scan(uint64_t subject, uint64_t scan, size_t n);

/* faces_build(out): Builds the face of faces_pts. */
void faces_build(struct surface_face *out);

/* faces_make(subject, scan, out): Builds the face of a scan of FACES_POINTS points. */
void faces_make(uint64_t subject, uint64_t scan, struct surface_face *out);

/* faces_mistake(f, size): Makes f as if it had been taken for a head so large. */
void faces_mistake(struct surface_face *f, double size);

#endif
