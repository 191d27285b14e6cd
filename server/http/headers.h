/* headers.h -- the headers that say how to read a request and how to respond to it. */
#ifndef SERVER_HEADERS_H
#define SERVER_HEADERS_H
#include <stdbool.h>

struct request;

/* Where the body ends, and so another request may begin, to which host it goes and for whom, as far
 * as the headers say so without doubt: a proxy in front must not read them in another way (RFC 9112
 * sections 3.2 and 11.2).  All zero at first. */
struct headers_framing {
    bool has_host, has_authorization;
    bool has_length;   /* a length or chunks are announced */
    bool coded;        /* a transfer coding is */
    bool other_coding; /* and it is not chunked: nobody knows its end */
    const char *wrong; /* why it is in doubt; NULL: it is not */
};

/* headers_frame(f, name, value): called with each header, as libmicrohttpd has them in its buffer.
 * headers_refuse(r, f, version): true: the request must not be served, and its connection ends;
 * r->response says why.  version: "HTTP/1.1". */
void headers_frame(struct headers_framing *f, const char *name, const char *value);
bool headers_refuse(struct request *r, const struct headers_framing *f,
                    const char *version);

/* headers_take(r, name, value): called with each header; a name may come
 * several times.
 *   Content-Encoding  sets r->coding; twice: INFLATE_OTHER
 *   Prefer            return=minimal sets r->minimal (RFC 7240); of several "return" the
 *                     first counts, other preferences are ignored
 *   Accept-Encoding   gzip sets r->gzip
 *   If-None-Match     r->none_match
 *   Origin            r->origin; Access-Control-Request-Method: r->preflight */
void headers_take(struct request *r, const char *name, const char *value);

#endif
