/* burst.h -- the files of a form that are enrolled together (multipart.h, enrolment.h). */
#ifndef SERVER_BURST_H
#define SERVER_BURST_H
#include <stddef.h>
#include "enrolment.h"
#include "multipart.h"
#include "sample.h"

struct request; /* request.h */

struct burst {
    size_t n; /* files */
    struct multipart_file file[MULTIPART_FILES_MAX];
    struct sample_found found[MULTIPART_FILES_MAX];
    struct surface_face *face[MULTIPART_FILES_MAX];
    /* for enrolment_add(): of a file that is refused no face, and the reason */
    struct store_sample sample[MULTIPART_FILES_MAX];
    struct enrolment_result each[MULTIPART_FILES_MAX];
};

/* burst_read(r, w): the faces of r's body, a form that multipart_read() has taken before, as for
 * enrolments.  The limits on a body and on the points of a cloud hold for all files together.
 * Returns a new object, released by burst_free(); NULL: r->response says why not. */
struct burst *burst_read(struct request *r, struct surface_work *w);

/* burst_respond(r, b): after enrolment_add() took one of them: what became of each file.
 * burst_refuse(r, b): it took none: the problem of the first file, with the same list. */
void burst_respond(struct request *r, const struct burst *b);
void burst_refuse(struct request *r, const struct burst *b);

void burst_free(struct burst *b); /* with its faces, wiped; NULL is allowed */

#endif
