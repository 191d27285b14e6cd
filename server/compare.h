/* compare.h -- two clouds of one request, nothing stored. */
#ifndef SERVER_COMPARE_H
#define SERVER_COMPARE_H

struct request;
struct worker;

/* a is the template, b the probe: the transform maps b onto a. */
void compare_handle(struct request *r, struct worker *w);

#endif
