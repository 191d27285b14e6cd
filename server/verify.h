/* verify.h -- a probe against the templates of a subject, or against one template. */
#ifndef SERVER_VERIFY_H
#define SERVER_VERIFY_H
#include <stdbool.h>
#include "admit.h"
#include "face.h"

struct errinfo;
struct request;
struct worker;

void verify_subject(struct request *r, struct worker *w);
void verify_template(struct request *r, struct worker *w);

/* verify_admitted(r, admit, e): as admit_subject() said; false: r->response says why not. */
bool verify_admitted(struct request *r, enum admit admit, const struct errinfo *e);

/* verify_event(r, kind, subject, template_id, decision): count the decision, and append
 * the event; when that fails the response stands, and the log says that it is missing. */
void verify_event(struct request *r, const char *kind, const char *subject,
                  const char *template_id, enum face_decision decision);

#endif
