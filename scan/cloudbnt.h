/* cloudbnt.h -- the reader of the Bosphorus database's files (.bnt) behind cloudfile.h. */
#ifndef SCAN_CLOUDBNT_H
#define SCAN_CLOUDBNT_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* cloudbnt_is(t): does a BNT file begin here: a header whose numbers agree? */
bool cloudbnt_is(const struct cloudtext *t);

/* cloudbnt_parse(t, list): t stands at the first byte of the file.  The rows of its grid go
 * from the bottom up, unlike an image's: the cloud is not called organised, so that it does
 * not seem to be a mirror image (mirror.h).  As cloudfile_read(). */
enum status cloudbnt_parse(struct cloudtext *t, struct cloudlist *list);

#endif
