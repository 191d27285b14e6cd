/* compare.h -- a probe against the templates of a subject, one template, or another scan
 * (service/verify.h). */
#ifndef SERVER_COMPARE_H
#define SERVER_COMPARE_H
#include <stdbool.h>

struct errinfo;           /* errinfo.h */
struct request;           /* request.h */
struct store_recorded;    /* store.h */
struct templates_refusal; /* templates.h */
struct worker;            /* worker.h */

void compare_subject(struct request *r, struct worker *w);
void compare_template(struct request *r, struct worker *w);
void compare_scans(struct request *r, struct worker *w);

/* compare_refuse(r, why, e): r->response is the problem of e, or that the subject may not
 * be verified: disabled, expired, or locked out with Retry-After, which counts in the
 * metrics. */
void compare_refuse(struct request *r, const struct templates_refusal *why,
                    const struct errinfo *e);

/* compare_warn(r, warnings): Writes the warnings of a struct store_recorded to the log and the metrics. */
void compare_warn(const struct request *r, unsigned warnings);

#endif
