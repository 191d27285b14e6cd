/* symmetry.h -- a cloud against its own mirror image, nothing stored. */
#ifndef SERVER_SYMMETRY_H
#define SERVER_SYMMETRY_H

struct request;
struct worker;

void symmetry_handle(struct request *r, struct worker *w);

#endif
