/* cloudobj.h -- the OBJ reader behind cloudfile.h. */
#ifndef SCAN_CLOUDOBJ_H
#define SCAN_CLOUDOBJ_H
#include <stdbool.h>
#include "status.h"

struct cloudlist; /* cloudlist.h */
struct cloudtext; /* cloudtext.h */

/* cloudobj_is(t): is the word here one that begins a line of an OBJ file? */
bool cloudobj_is(const struct cloudtext *t);

/* cloudobj_parse(t, list): the vertices from t on, as cloudfile_read() says. */
enum status cloudobj_parse(struct cloudtext *t, struct cloudlist *list);

#endif
