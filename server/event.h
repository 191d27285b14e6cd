/* event.h -- entries of the audit log that a response does not wait for. */
#ifndef SERVER_EVENT_H
#define SERVER_EVENT_H

struct errinfo;
struct request;

/* event_add(r, kind, outcome): an entry of r, its subject and template; where it is lost, r's
 * response stands. */
void event_add(struct request *r, const char *kind, const char *outcome);

#endif
