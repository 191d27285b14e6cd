/* cloud.h -- the scans that the body of a request has: one file, or the files of a form (multipart.h), as a
 * session (session.h). */
#ifndef SERVER_CLOUD_H
#define SERVER_CLOUD_H
#include <stdbool.h>
#include <stddef.h>
#include "multipart.h"
#include "session.h"

struct errinfo; /* errinfo.h */
struct request; /* request.h */
struct worker;  /* worker.h */

struct cloud {
    struct multipart_file file[MULTIPART_FILES_MAX]; /* headers of the parts of a form */
    struct session session;
};

/* cloud_open(r, most): Takes ownership of the body of r, and lists its files.  The query parameters of r say
 * how to read them.  The limits on a body and on the points of a scan hold for all files together.
 *   most  largest number of files, at most MULTIPART_FILES_MAX
 * Returns a new object, to be released by cloud_free(); NULL: r->response is set. */
struct cloud *cloud_open(struct request *r, size_t most);

/* cloud_open_two(r, a, b): Reads the body {"a": cloud, "b": cloud}, or a form with the files a and b.
 *   a, b  new objects, to be released by cloud_free(), also after a failure; NULL: out of memory
 * Returns false: r->response is set, or the client has disconnected. */
bool cloud_open_two(struct request *r, struct cloud **a, struct cloud **b);

/* cloud_read(r, c): Reads the points by session_read(), and measures the time.
 * Returns false: r->response is set, or the client has disconnected. */
bool cloud_read(struct request *r, struct cloud *c);

/* cloud_build(r, c, enrolment, w): Builds the face w->probe by session_build(), and measures the time.
 *   enrolment  as in struct sample_options
 * Returns false: r->response is set, or the client has disconnected. */
bool cloud_build(struct request *r, struct cloud *c, bool enrolment, struct worker *w);

/* cloud_refuse(r, c, e): Responds with the problem of e, which concerns the scan; for a form with the list of
 * its files. */
void cloud_refuse(struct request *r, const struct cloud *c, const struct errinfo *e);

/* cloud_free(c): Frees c with its points, wiped; NULL is allowed. */
void cloud_free(struct cloud *c);

#endif
