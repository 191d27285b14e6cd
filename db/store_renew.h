/* store_renew.h -- every secret of a database anew, where the old ones are known to others. */
#ifndef DB_STORE_RENEW_H
#define DB_STORE_RENEW_H
#include "store_types.h"

struct store_act; /* store_rules.h */
struct store_txn; /* store_txn.h */
struct vault;     /* vault.h */

/* store_renew_subjects(s, actor, e): a new key for each subject, under the database's vault, and all
 * of the subject encrypted again, its templates too.  A transaction each 64 subjects: other
 * programs go on meanwhile.  Called again within an hour after it was interrupted, it goes on.
 * store_renew(t, by, next, kept, e): then, inside a transaction: everything that has a hash, a MAC
 * or a wrapped key of t's vault gets one of the next, which t has from then on; the audit log has
 * an entry for each row.  The old key signs the new one.  Of scans that came before only those
 * that templates are are known afterwards (templates.same).  kept: the outcome of that entry. */
enum status store_renew_subjects(struct store *s, const char *actor, struct errinfo *e);
enum status store_renew(struct store_txn *t, const struct store_act *by,
                        const struct vault *next, const char *kept, struct errinfo *e);

#endif
