/* logs.h -- the audit log: listed, verified, as a file. */
#ifndef SERVER_LOGS_H
#define SERVER_LOGS_H

struct request;
struct worker;

void logs_list(struct request *r, struct worker *w);

#endif
