/* cloudpcd.h -- the PCD reader behind cloudfile.h. */
#ifndef SCAN_CLOUDPCD_H
#define SCAN_CLOUDPCD_H
#include <stdbool.h>
#include <stddef.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

#define CLOUDPCD_FIELDS 64

/* cloudpcd_is(t): does a PCD file begin here? */
bool cloudpcd_is(const struct cloudtext *t);

/* cloudpcd_parse(t, max_bytes, list): t stands at the first byte of the file.  max_bytes: of
 * compressed data, when unpacked.  As cloudfile_read(); ST_EVERSION also for more than
 * CLOUDPCD_FIELDS fields. */
enum status cloudpcd_parse(struct cloudtext *t, size_t max_bytes, struct cloudlist *list);

#endif
