/* identify_scan.h -- POST /v1/identify: who of all people is it? */
#ifndef SERVER_IDENTIFY_SCAN_H
#define SERVER_IDENTIFY_SCAN_H

#include <stdbool.h>

struct request;
struct worker;

/* identify_scan_may(r): Returns true if there is a gallery to be searched, and the token may search now.  Else r->response
 * says why not. */
bool identify_scan_may(struct request *r);

void identify_scan(struct request *r, struct worker *w);

#endif
