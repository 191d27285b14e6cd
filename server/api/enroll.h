/* enroll.h -- handler that makes templates of a subject from one scan or several. */
#ifndef SERVER_ENROLL_H
#define SERVER_ENROLL_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* enroll_handle(r, w): Enrols the scans of the body.  Refuses the subject before it works on them. */
void enroll_handle(struct request *r, struct worker *w);

#endif
