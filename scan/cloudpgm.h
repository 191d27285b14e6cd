/* cloudpgm.h -- the reader of depth images in PGM behind cloudfile.h. */
#ifndef SCAN_CLOUDPGM_H
#define SCAN_CLOUDPGM_H
#include <stdbool.h>
#include "status.h"

struct clouddepth_camera; /* clouddepth.h */
struct cloudlist;         /* cloudlist.h */
struct cloudtext;         /* cloudtext.h */

/* cloudpgm_is(t): does a PGM file begin here? */
bool cloudpgm_is(const struct cloudtext *t);

/* cloudpgm_parse(t, camera, list): P5 (binary) and P2 (text), of 16 bits, as clouddepth.h
 * says.  As cloudfile_read(); ST_EVERSION: no camera is given, or the pixels are of 8 bits. */
enum status cloudpgm_parse(struct cloudtext *t, const struct clouddepth_camera *camera,
                           struct cloudlist *list);

#endif
