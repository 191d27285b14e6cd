/* cloudobj.h -- the OBJ reader behind cloudfile.h. */
#ifndef SCAN_CLOUDOBJ_H
#define SCAN_CLOUDOBJ_H
#include <stdbool.h>
#include "status.h"

struct cloudtext;        /* cloudtext.h */
struct cloudtext_points; /* cloudtext.h */

/* cloudobj_is(t): is the word here one that begins a line of an OBJ file? */
bool cloudobj_is(const struct cloudtext *t);

/* cloudobj_parse(t, list): the vertices from t on, as cloudfile_parse() says. */
enum status cloudobj_parse(struct cloudtext *t, struct cloudtext_points *list);

#endif
