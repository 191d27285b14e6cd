/* headcamera.h -- a depth camera that measures by triangulation: a pixel's error and its
 * steps grow with the square of the distance; edges smear, and the shadow beside them is
 * empty. */
#ifndef TOOLS_HEADCAMERA_H
#define TOOLS_HEADCAMERA_H

struct head;             /* head.h */
struct headscan;         /* headspec.h */
struct headscan_options; /* headspec.h */

#define HEADCAMERA_WIDTH  640
#define HEADCAMERA_HEIGHT 480
#define HEADCAMERA_FOCAL  600.0 /* pixels; the centre is the middle of the image */

/* headcamera_see(s, o, out): the scene s, moved o->distance away from the camera, which is
 * the origin and looks along -z; a wall behind. */
void headcamera_see(struct head *s, const struct headscan_options *o,
                    struct headscan *out);

#endif
