/* malformed.h -- the problem documents of what libmicrohttpd refuses by itself. */
#ifndef SERVER_MALFORMED_H
#define SERVER_MALFORMED_H

struct request;

/* malformed_explain(r, status): sets r->response; status: the one that it would respond with. */
void malformed_explain(struct request *r, unsigned status);

#endif
