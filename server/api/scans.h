/* scans.h -- handlers of a scan that is not stored, and of a template's surface. */
#ifndef SERVER_SCANS_H
#define SERVER_SCANS_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* scans_check(r, w): Reports whether the scan would be accepted, and what to change at the scanner.  With
 * detail=surface responds with a 3D file, if the scan has points. */
void scans_check(struct request *r, struct worker *w);

/* scans_asymmetry(r, w): Compares the scan with its own mirror image. */
void scans_asymmetry(struct request *r, struct worker *w);

/* scans_template(r, w): Sends the surface of a template as GLB, or as PLY with format=ply.  Records it as an
 * export. */
void scans_template(struct request *r, struct worker *w);

#endif
