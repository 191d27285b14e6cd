/* explain_text.h -- an explanation in words and in JSON. */
#ifndef CTL_EXPLAIN_TEXT_H
#define CTL_EXPLAIN_TEXT_H
#include <stdio.h>
#include "errinfo.h"
#include "explain.h"

struct json; /* json.h */

/* Writers of explain.txt and explain.json (ctl_dir.h); x is a struct explanation.  Return
 * ST_OK; the second ST_ENOMEM, ST_EIO with e filled. */
enum status explain_text(FILE *to, const void *x, struct errinfo *e);
enum status explain_text_json(FILE *to, const void *x, struct errinfo *e);

/* explain_text_out(o, x): what explain.json has, as members of o's open object. */
void explain_text_out(struct json *o, const struct explanation *x);

#endif
