/* headers.h -- the headers that say how to read a request and how to respond to it. */
#ifndef SERVER_HEADERS_H
#define SERVER_HEADERS_H
#include <stdbool.h>

struct request;

/* The framing of a request by its headers: the end of the body, where the next request begins, the host and the
 * token.  A proxy in front of the daemon must not read it in another way (RFC 9112 sections 3.2 and 11.2).
 * All zero at first. */
struct headers_framing {
    bool has_host, has_authorization;
    bool has_length; /* there is a length or a transfer coding */
    bool coded;      /* there is a transfer coding */
    bool
        other_coding; /* a transfer coding is not chunked: the end of the body is unknown */
    const char *wrong; /* reason why the framing is ambiguous; NULL: it is clear */
};

/* headers_take(r, f, name, value): Reads a header, as it lies in libmicrohttpd's buffer, into f and r.  A name
 * may come several times.
 *   Content-Encoding  sets r->coding; twice: INFLATE_OTHER
 *   Prefer            return=minimal sets r->minimal (RFC 7240); of several "return" the
 *                     first counts, other preferences are ignored
 *   Accept-Encoding   gzip sets r->gzip
 *   If-None-Match     sets r->none_match
 *   Origin            sets r->origin
 *   Host              sets r->host
 *   Sec-Fetch-Site    sets r->cross_site
 *   Capture-Signature goes to capture_take()
 *   Access-Control-Request-Method  sets r->preflight */
void headers_take(struct request *r, struct headers_framing *f, const char *name,
                  const char *value);

/* headers_refuse(r, f, version): Returns true if the request must not be served, and its connection must end;
 * then sets r->response.
 *   version  "HTTP/1.1" */
bool headers_refuse(struct request *r, const struct headers_framing *f,
                    const char *version);

#endif
