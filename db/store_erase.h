/* store_erase.h -- subjects erased: the bytes are overwritten, and leave the WAL. */
#ifndef DB_STORE_ERASE_H
#define DB_STORE_ERASE_H
#include "store_types.h"

/* store_subject_erase(s, actor, subject, out, e): the subject and all its templates, also one
 * whose row is damaged.  *out is released by store_receipt_free(), also on failure.
 * ST_EHELD: it is on hold.
 * store_subject_purge(s, actor, subject, e): only if it has expired, else ST_ENOTFOUND; not
 * one whose row is damaged. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);

#endif
