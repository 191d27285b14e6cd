/* check.h -- what would be done with a cloud, and what to change at the scanner; nothing is
 * stored. */
#ifndef SERVER_CHECK_H
#define SERVER_CHECK_H

struct request;
struct worker;

void check_handle(struct request *r, struct worker *w);

#endif
