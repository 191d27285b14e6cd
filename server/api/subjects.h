/* subjects.h -- handlers of subjects and of the descriptions of their templates. */
#ifndef SERVER_SUBJECTS_H
#define SERVER_SUBJECTS_H

struct request; /* request.h */
struct worker;  /* worker.h */

void subjects_list(struct request *r, struct worker *w);
void subjects_show(struct request *r, struct worker *w);
void subjects_add(struct request *r, struct worker *w);
void subjects_change(struct request *r, struct worker *w);
void subjects_delete(struct request *r, struct worker *w);
void subjects_template(struct request *r, struct worker *w);
void subjects_template_delete(struct request *r, struct worker *w);

#endif
