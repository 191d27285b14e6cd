/* logs.h -- the audit log: listed, verified, as a file. */
#ifndef SERVER_LOGS_H
#define SERVER_LOGS_H

struct request;
struct worker;

void logs_list(struct request *r, struct worker *w);

/* Slow routes (route.h): logs_verify() reads everything; logs_export() writes it into a file without
 * a name, or, with the subjects' ids in it, into memory, before it is sent. */
void logs_verify(struct request *r, struct worker *w);
void logs_export(struct request *r, struct worker *w);

#endif
