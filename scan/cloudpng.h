/* cloudpng.h -- the reader of depth images in PNG behind cloudfile.h. */
#ifndef SCAN_CLOUDPNG_H
#define SCAN_CLOUDPNG_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct clouddepth_camera; /* clouddepth.h */
struct cloudlist;         /* cloudlist.h */
struct cloudtext;         /* cloudtext.h */

/* cloudpng_is(t): does a PNG file begin here? */
bool cloudpng_is(const struct cloudtext *t);

/* cloudpng_parse(t, camera, max_bytes, list): an image of 16 bits a pixel, grey, as
 * clouddepth.h says.  max_bytes: of the pixels when unpacked, 2 bytes each.  As
 * cloudfile_read(); ST_EVERSION: no camera is given, or the pixels are not of 16 bits and
 * grey. */
enum status cloudpng_parse(struct cloudtext *t, const struct clouddepth_camera *camera,
                           size_t max_bytes, struct cloudlist *list);

#endif
