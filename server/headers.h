/* headers.h -- the headers that say how to read a request and how to respond to it. */
#ifndef SERVER_HEADERS_H
#define SERVER_HEADERS_H

struct request;

/* headers_take(r, name, value): called with each header; a name may come
 * several times.
 *   Content-Encoding  sets r->coding; twice: INFLATE_OTHER
 *   Prefer            return=minimal sets r->minimal (RFC 7240); of several "return" the
 *                     first counts, other preferences are ignored
 *   Idempotency-Key   sets r->key: a string in quotes, or bare; r->bad_key where it is
 *                     neither, or not 1..REQUEST_KEY_MAX visible characters, or given twice */
void headers_take(struct request *r, const char *name, const char *value);

#endif
