/* cloudabs.h -- the reader of FRGC's range images (.abs) behind cloudfile.h. */
#ifndef SCAN_CLOUDABS_H
#define SCAN_CLOUDABS_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* cloudabs_is(t): does an ABS file begin here, with a line like "480 rows"? */
bool cloudabs_is(const struct cloudtext *t);

/* cloudabs_parse(t, list): an organised cloud; a point whose flag is 0 has no value.  t
 * stands at the first byte of the file.  As cloudfile_read(); ST_EVERSION also for other
 * lists than flag, X, Y and Z. */
enum status cloudabs_parse(struct cloudtext *t, struct cloudlist *list);

#endif
