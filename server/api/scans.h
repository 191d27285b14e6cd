/* scans.h -- one cloud, of which nothing is stored. */
#ifndef SERVER_SCANS_H
#define SERVER_SCANS_H

struct request;
struct worker;

/* scans_check(r, w): what would be done with it, and what to change at the scanner.
 * scans_asymmetry(r, w): it against its own mirror image. */
void scans_check(struct request *r, struct worker *w);
void scans_asymmetry(struct request *r, struct worker *w);

#endif
