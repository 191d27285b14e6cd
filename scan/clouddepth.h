/* clouddepth.h -- the points of a depth image, whose values are distances along the camera's axis; and the reader
 * of images without a header behind cloudfile.h.  For the readers of PNG, PGM and NPY. */
#ifndef SCAN_CLOUDDEPTH_H
#define SCAN_CLOUDDEPTH_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* A pinhole camera without distortion. */
struct clouddepth_camera {
    double fx, fy; /* focal length, pixels; not above 0 or NaN: not given */
    double cx, cy; /* point of the image on the camera's axis, pixels; the first pixel has
                      its middle at 0; NaN: not given */
    /* 0: not given, and an integer is a millimetre. Programs mean three things by it, which
     * no camera's numbers confuse: from 100, how many values are a metre (TUM's 5000); up to
     * 0.01, how many metres a value is (librealsense's 0.001); between them, how many
     * millimetres it is */
    double scale;
    /* size of a file without a header (CLOUDFORMAT_RAW), pixels; 0: not given */
    uint32_t width, height;
};

#define CLOUDDEPTH_SIDE_MAX 65535 /* of width and height */
#define CLOUDDEPTH_NONE                                                                  \
    65535 /* the largest number of 16 bits is no distance, as 0 is none */

#define CLOUDDEPTH_NO_CAMERA                                                             \
    {                                                                                    \
        .fx = NAN, .fy = NAN, .cx = NAN, .cy = NAN                                       \
    }

/* An image while its values are added, row by row from the top. */
struct clouddepth {
    const struct clouddepth_camera *camera;
    struct cloudlist *list;
    double mm;     /* millimetres per value */
    uint32_t u, v; /* column and row of the next one */
};

/* clouddepth_begin(d, camera, width, height, list): Begins an organised cloud in millimetres: x to the image's
 * right, y up, z towards the camera, which is at the origin.
 * Returns ST_OK; ST_EVERSION: no camera is given; with a message. */
enum status clouddepth_begin(struct clouddepth *d, const struct clouddepth_camera *camera,
                             uint32_t width, uint32_t height, struct cloudlist *list);

/* clouddepth_add(d, value): Adds the next pixel.  A value that is not above 0, or CLOUDDEPTH_NONE, is none.
 * Returns as cloudlist_add(). */
enum status clouddepth_add(struct clouddepth *d, double value);

/* clouddepth_values(t, camera, width, height, big, list): Reads everything from t on as integers of two bytes.
 * Returns ST_EINVAL also if their number is not the image's. */
enum status clouddepth_values(struct cloudtext *t, const struct clouddepth_camera *camera,
                              uint32_t width, uint32_t height, bool big,
                              struct cloudlist *list);

/* clouddepth_camera_read(text, c): Reads "FX,FY,CX,CY[,SCALE[,WIDTH,HEIGHT]]".  Returns false if the text is
 * something else. */
bool clouddepth_camera_read(const char *text, struct clouddepth_camera *c);

#endif
