/* cloudxyz.h -- the XYZ reader behind cloudfile.h. */
#ifndef SCAN_CLOUDXYZ_H
#define SCAN_CLOUDXYZ_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* cloudxyz_is(t): can what is here begin the first line of an XYZ file? */
bool cloudxyz_is(const struct cloudtext *t);

/* cloudxyz_parse(t, list): the points from t on, as cloudfile_read() says. */
enum status cloudxyz_parse(struct cloudtext *t, struct cloudlist *list);

#endif
