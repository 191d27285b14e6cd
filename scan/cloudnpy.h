/* cloudnpy.h -- the reader of NumPy's arrays (.npy) behind cloudfile.h. */
#ifndef SCAN_CLOUDNPY_H
#define SCAN_CLOUDNPY_H
#include <stdbool.h>
#include "status.h"

struct clouddepth_camera; /* clouddepth.h */
struct cloudlist;         /* cloudlist.h */
struct cloudtext;         /* cloudtext.h */

#define CLOUDNPY_VALUES                                                                  \
    16 /* that a point may have; with more it is the row of an image */

/* cloudnpy_is(t): does an NPY file begin here? */
bool cloudnpy_is(const struct cloudtext *t);

/* cloudnpy_parse(t, camera, list): an array of floats or integers, in C or Fortran order, is by
 * its shape, C being from 3 to CLOUDNPY_VALUES of which the first three are x, y and z:
 *   (N, C), (3, N)   points
 *   (H, W, C)        an organised cloud
 *   (H, W)           a depth image as clouddepth.h says; of floats without a scale the unit is
 *                    not known
 * t stands at the first byte of the file.  As cloudfile_read(); ST_EVERSION also for other
 * types and shapes, and for a depth image without a camera. */
enum status cloudnpy_parse(struct cloudtext *t, const struct clouddepth_camera *camera,
                           struct cloudlist *list);

#endif
