/* meta.h -- what the daemon says about itself. */
#ifndef SERVER_META_H
#define SERVER_META_H

struct request;
struct worker;

void meta_metrics(struct request *r, struct worker *w);
void meta_openapi(struct request *r, struct worker *w);
void meta_version(struct request *r, struct worker *w);

#endif
