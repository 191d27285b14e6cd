/* ctl_review.h -- a file that `audit export` wrote, verified without its database. */
#ifndef CTL_REVIEW_H
#define CTL_REVIEW_H
#include "ctl.h"
#include "store.h"

struct ctl_review {
    log_report *report; /* called with the command */
    /* NULL, or called with arg of each change, which may be none of the log's: the walk says so */
    void (*change)(void *arg, const struct log_entry *entry);
    void *arg;
};

/* ctl_review_file(c, how, out): the file of the first argument under --public-key.  Its last
 * change must be signed by that key: its hash covers all before it, and names the last access. */
enum status ctl_review_file(struct ctl *c, const struct ctl_review *how,
                            struct log_walk *out);

#endif
