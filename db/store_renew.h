/* store_renew.h -- every secret of a database anew, where the old ones are known to others. */
#ifndef DB_STORE_RENEW_H
#define DB_STORE_RENEW_H
#include "store_types.h"

struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */
struct vault;     /* vault.h */

/* store_renew(t, by, next, kept, e): inside a transaction, under the next vault, which t has from
 * then on: each subject gets a new key and all of it is encrypted again with its templates; it is
 * found by other hashes; the audit log gets new MACs at its ends, and an entry for each row.  The
 * old key signs the new one.  Of scans that came before only those that templates are are known
 * afterwards (templates.same).  kept: the outcome of that entry. */
enum status store_renew(struct store_txn *t, const struct store_act *by,
                        const struct vault *next, const char *kept, struct errinfo *e);

#endif
