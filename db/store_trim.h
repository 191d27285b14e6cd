/* store_trim.h -- how long the audit log keeps its uses. */
#ifndef DB_STORE_TRIM_H
#define DB_STORE_TRIM_H
#include "store_types.h"

#define STORE_TRIM_MAX 36500 /* days */

/* store_audit_trim(s, actor, days, dry, cut, e): the oldest uses, up to the first that is younger
 * than so many days, 1.., are cut off; a change says up to which, with the hash of the last, from
 * where the chain goes on.  A number of them at a time, each a transaction.  dry: they are only
 * counted.  *cut: how many. */
enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e);

#endif
