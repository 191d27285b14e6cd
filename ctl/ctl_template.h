/* ctl_template.h -- a template described, as JSON and text. */
#ifndef CTL_TEMPLATE_H
#define CTL_TEMPLATE_H

struct ctl;            /* ctl.h */
struct store_template; /* store.h */

/* ctl_template_tell(c, t): Adds the description of a template to the result. */
void ctl_template_tell(struct ctl *c, const struct store_template *t);

#endif
