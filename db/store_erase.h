/* store_erase.h -- subjects erased: the bytes are overwritten, and leave the WAL. */
#ifndef DB_STORE_ERASE_H
#define DB_STORE_ERASE_H
#include "store_types.h"

struct row_event_row; /* row_event.h */
struct store_act;     /* store_rules.h */
struct store_txn;     /* store_txn.h */

/* store_subject_erase(s, actor, subject, out, e): the subject and all its templates, also one
 * whose row is damaged.  *out is released by store_receipt_free(), also on failure.
 * ST_EHELD: it is on hold.
 * store_subject_purge(s, actor, subject, e): only if it has expired, else ST_ENOTFOUND; not
 * one whose row is damaged. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);

/* store_erase_row(t, by, subject, outcome, row, gone, template_id, n, e): the row and its
 * templates' are deleted, and the audit log says so of each; gone: whose it was.  The templates'
 * ids are released by free(). */
enum status store_erase_row(struct store_txn *t, const struct store_act *by,
                            const char *subject, const char *outcome, int64_t row,
                            const struct row_event_row *gone,
                            char (**template_id)[STORE_ID_LEN + 1], size_t *n,
                            struct errinfo *e);

/* store_erased_since(s, since, erased, e): has any process erased a subject or a template since
 * the last call with this *since, at first 0?  What is kept of them in memory is to be
 * dropped then.  O(events since). */
enum status store_erased_since(struct store *s, int64_t *since, bool *erased,
                               struct errinfo *e);

#endif
