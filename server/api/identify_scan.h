/* identify_scan.h -- POST /v1/identify: who of all people is it? */
#ifndef SERVER_IDENTIFY_SCAN_H
#define SERVER_IDENTIFY_SCAN_H

struct request;
struct worker;

void identify_scan(struct request *r, struct worker *w);

#endif
