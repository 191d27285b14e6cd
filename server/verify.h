/* verify.h -- a probe against the templates of a subject, or against one template.
 * All that it reads is one transaction (admission.h), and so is all that it writes
 * (store_settle()): what was not counted and recorded is not told. */
#ifndef SERVER_VERIFY_H
#define SERVER_VERIFY_H
#include <stdbool.h>
#include "admit.h"

struct describe_comparison;
struct errinfo;
struct face_result;
struct minimal;
struct request;
struct worker;

void verify_subject(struct request *r, struct worker *w);
void verify_template(struct request *r, struct worker *w);

/* verify_admitted(r, admit, e): as admit_subject() said; false: r->response says why not. */
bool verify_admitted(struct request *r, enum admit admit, const struct errinfo *e);

/* verify_round(r, w, result, least): where r's token tells no more than decisions (neither detail
 * nor manage), the measures to be told are rounded (face_round()): many exact scores would
 * rebuild a face. */
void verify_round(const struct request *r, const struct worker *w,
                  struct face_result *result, struct minimal *least);

/* verify_respond(r, c): 200 with c; without c->minimal because the client prefers so. */
void verify_respond(struct request *r, const struct describe_comparison *c);

#endif
