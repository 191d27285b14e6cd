/* ctl_review.h -- a file that `audit export` wrote, verified without its database. */
#ifndef CTL_REVIEW_H
#define CTL_REVIEW_H
#include "ctl.h"
#include "store.h"

/* ctl_review_file(c, report, out): the file of the first argument by --public-key.  report() is
 * called with c. */
enum status ctl_review_file(struct ctl *c, store_chain_report *report,
                            struct store_audit *out);

#endif
