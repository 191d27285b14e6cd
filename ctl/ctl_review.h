/* ctl_review.h -- a file that `audit export` wrote, verified without its database. */
#ifndef CTL_REVIEW_H
#define CTL_REVIEW_H
#include "ctl.h"
#include "store.h"

/* ctl_review_file(c, report, out): the file of the first argument under --public-key.  Its last
 * change must be signed by that key: its hash covers all before it, and names the last access.
 * report() is called with c. */
enum status ctl_review_file(struct ctl *c, log_report *report, struct log_walk *out);

#endif
