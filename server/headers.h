/* headers.h -- the fields of a request's head that say how to read it and how to answer. */
#ifndef SERVER_HEADERS_H
#define SERVER_HEADERS_H

struct request;

/* headers_take(r, name, value): called with each line of the head; a field may stand in
 * several.  Sets r->coding by Content-Encoding. */
void headers_take(struct request *r, const char *name, const char *value);

#endif
