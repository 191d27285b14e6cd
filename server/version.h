/* version.h -- which program this is. */
#ifndef SERVER_VERSION_H
#define SERVER_VERSION_H

struct request;
struct worker;

void version_handle(struct request *r, struct worker *w);

#endif
