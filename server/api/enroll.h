/* enroll.h -- a cloud, or several, become templates of a subject. */
#ifndef SERVER_ENROLL_H
#define SERVER_ENROLL_H

struct request;
struct worker;

void enroll_handle(struct request *r, struct worker *w);

#endif
