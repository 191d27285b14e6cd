/* form.h -- the files of a form that are the frames of one capture session (multipart.h,
 * session.h). */
#ifndef SERVER_FORM_H
#define SERVER_FORM_H
#include <stddef.h>
#include "multipart.h"
#include "session.h"

struct errinfo; /* errinfo.h */
struct request; /* request.h */

struct form {
    struct multipart_file file[MULTIPART_FILES_MAX]; /* their data has gone */
    struct session session;
    double parse_ms;
};

/* form_read(r, most): the points of the files of r's body, at most so many, which is released.  A
 * file that is no scan is left out, with the reason.  The limits on a body and on the points of a
 * cloud hold for all files together.
 * Returns a new object, released by form_free(); NULL: r->response says why not. */
struct form *form_read(struct request *r, size_t most);

/* form_refuse(r, f, e): the problem of e, which is about the frames, with what became of each. */
void form_refuse(struct request *r, const struct form *f, const struct errinfo *e);

void form_free(struct form *f); /* with its points, wiped; NULL is allowed */

#endif
