/* store_erase.h -- subjects erased: the bytes are overwritten, and leave the WAL. */
#ifndef DB_STORE_ERASE_H
#define DB_STORE_ERASE_H
#include "store_types.h"

/* store_subject_delete(s, actor, subject, removed, e): the subject and all its templates.
 * removed: how many templates went; may be NULL.  ST_EHELD: it is on hold.  One whose row is
 * damaged may be erased too.
 * store_subject_purge(s, actor, subject, e): the same if it has expired; else ST_ENOTFOUND.
 * store_subject_erase(s, actor, subject, out, e): the same with a receipt; *out is to be
 * released by store_receipt_free(), also on failure. */
enum status store_subject_delete(struct store *s, const char *actor, const char *subject,
                                 uint32_t *removed, struct errinfo *e);
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);

#endif
