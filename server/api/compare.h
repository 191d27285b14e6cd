/* compare.h -- handlers that compare a probe with the templates of a subject, with one template, or with
 * another scan (service/verify.h), and the templates of a subject with each other (service/pairs.h). */
#ifndef SERVER_COMPARE_H
#define SERVER_COMPARE_H

struct request; /* request.h */
struct worker;  /* worker.h */

void compare_subject(struct request *r, struct worker *w);
void compare_template(struct request *r, struct worker *w);
void compare_scans(struct request *r, struct worker *w);
void compare_templates(struct request *r, struct worker *w);

#endif
