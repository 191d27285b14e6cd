/* cloudstl.h -- the STL reader behind cloudfile.h. */
#ifndef SCAN_CLOUDSTL_H
#define SCAN_CLOUDSTL_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* cloudstl_is(t): does an STL file begin here: the word solid, or a binary file of just the
 * length that its count says? */
bool cloudstl_is(const struct cloudtext *t);

/* cloudstl_parse(t, list): t stands at the first byte of the file.  As cloudfile_read(). */
enum status cloudstl_parse(struct cloudtext *t, struct cloudlist *list);

#endif
