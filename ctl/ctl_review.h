/* ctl_review.h -- a file that the database signed, verified: an export of the audit log, or the receipt
 * of an erasure. */
#ifndef CTL_REVIEW_H
#define CTL_REVIEW_H
#include "ctl.h"
#include "store.h"

struct ctl_review {
    log_report *report; /* receives the problems; its arg is the command */
    /* Receives each change of an export with arg; NULL: none.  A change that is not of the log has a
     * problem reported too. */
    void (*change)(void *arg, const struct log_entry *entry);
    void *arg;
};

/* ctl_review_file(c, how, out, receipt): Verifies the file of the first argument; "-": standard input.
 *   export   its last change must be signed by --public-key: its hash covers all changes before it, and
 *            names the last access
 *   receipt  its signature must be by its own key, which must be --public-key if that is given.  With a
 *            database: its log must have the entry, and none of the templates may exist
 *   out      has the problems
 *   receipt  set if the file is one (entry.seq > 0), to be released by store_receipt_free(); NULL: only an
 *            export is accepted
 * Returns ST_OK also if there are problems; ST_EINVAL: the file is neither, or a key is missing;
 * ST_EVERSION, ST_ENOTFOUND, ST_EIO. */
enum status ctl_review_file(struct ctl *c, const struct ctl_review *how,
                            struct log_walk *out, struct store_receipt *receipt);

#endif
