/* store_erase.h -- subjects erased: the bytes are overwritten, and leave the WAL. */
#ifndef DB_STORE_ERASE_H
#define DB_STORE_ERASE_H
#include "store_open.h"
#include "store_receipt.h"

struct log_act;      /* log_entry.h */
struct log_txn;      /* log_txn.h */
struct rows_subject; /* rows_subject.h */

/* store_subject_erase(s, actor, subject, out, e): the subject and all its templates.  *out is
 * released by store_receipt_free(), also on failure.  ST_EHELD: it is on hold.
 * store_subject_purge(s, actor, subject, e): only if it has expired, else ST_ENOTFOUND. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);

/* store_erase_rows(t, by, of, outcome, out, e): the subject's row and its templates' are deleted,
 * with a change for each; out: NULL, or receives the templates' ids. */
enum status store_erase_rows(struct log_txn *t, const struct log_act *by,
                             const struct rows_subject *of, const char *outcome,
                             struct store_receipt *out, struct errinfo *e);

/* store_erased_since(s, since, erased, e): has any process erased a subject or a template since
 * the last call with this *since, at first 0?  What is kept of them in memory is to be
 * dropped then.  O(changes since). */
enum status store_erased_since(struct store *s, int64_t *since, bool *erased,
                               struct errinfo *e);

#endif
