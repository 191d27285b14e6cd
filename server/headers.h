/* headers.h -- the fields of a request's head that say how to read it and how to answer. */
#ifndef SERVER_HEADERS_H
#define SERVER_HEADERS_H

struct request;

/* headers_take(r, name, value): called with each line of the head; a field may stand in
 * several.
 *   Content-Encoding  sets r->coding; in two lines it is INFLATE_OTHER
 *   Prefer            return=minimal sets r->minimal (RFC 7240); of several "return" the
 *                     first counts, what else is preferred is ignored
 *   Idempotency-Key   sets r->key: a string in quotes, or bare; r->bad_key where it is
 *                     neither, or not 1..REQUEST_KEY_MAX visible characters, or given twice */
void headers_take(struct request *r, const char *name, const char *value);

#endif
