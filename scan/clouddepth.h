/* clouddepth.h -- the reader of depth images behind cloudfile.h: PNG of 16-bit grey values, a
 * value for the distance along the camera's axis at each pixel. */
#ifndef SCAN_CLOUDDEPTH_H
#define SCAN_CLOUDDEPTH_H
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* A pinhole camera without distortion. */
struct clouddepth_camera {
    double fx, fy; /* focal length, pixels; not above 0 or NaN: not given */
    double cx, cy; /* where its axis meets the image, pixels, of which the first has its
                      centre at 0; NaN: not given */
    /* 0: a value is a millimetre. Programs mean three things by it, which no camera's
     * numbers confuse: from 100, how many values are a metre (TUM's 5000); up to 0.01,
     * how many metres a value is (librealsense's 0.001); between them, how many
     * millimetres it is */
    double scale;
};

#define CLOUDDEPTH_NO_CAMERA                                                             \
    {                                                                                    \
        .fx = NAN, .fy = NAN, .cx = NAN, .cy = NAN                                       \
    }

/* clouddepth_is(t): does a PNG file begin here? */
bool clouddepth_is(const struct cloudtext *t);

/* clouddepth_parse(t, camera, max_bytes, list): an organised cloud in millimetres: x to the
 * image's right, y up, z towards the camera, which is at the origin.  The value 0 is none.
 * max_bytes: of the pixels, 2 bytes each.  As cloudfile_read(); ST_EVERSION: no camera is
 * given, or the pixels are not of 16 bits and grey. */
enum status clouddepth_parse(struct cloudtext *t, const struct clouddepth_camera *camera,
                             size_t max_bytes, struct cloudlist *list);

#endif
