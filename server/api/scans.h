/* scans.h -- one cloud, of which nothing is stored. */
#ifndef SERVER_SCANS_H
#define SERVER_SCANS_H

struct request;
struct worker;

/* scans_check(r, w): what would be done with it, and what to change at the scanner; with
 * detail=surface as a 3D file, where there is something to look at.
 * scans_asymmetry(r, w): it against its own mirror image. */
/* scans_template(r, w): the surface of a template, as GLB or, by format=ply, as PLY; recorded like
 * an export. */
void scans_template(struct request *r, struct worker *w);

void scans_check(struct request *r, struct worker *w);
void scans_asymmetry(struct request *r, struct worker *w);

#endif
