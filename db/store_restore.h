/* store_restore.h -- a backup in the place of the database. */
#ifndef DB_STORE_RESTORE_H
#define DB_STORE_RESTORE_H
#include "store_types.h"

/* store_restore(path, from, key, actor, dry, out, e): the backup in the place of the
 * database, which is kept as PATH.before-restore, or with dry nothing but *out.  Subjects that
 * were erased since, under whatever id, are erased; tokens keep the secrets that they have, and
 * are revoked if they are.  A database that is missing is made.
 * ST_EBUSY: another process has the database open; ST_EMISMATCH: it is another database's
 * backup; ST_EEXISTS: there is a PATH.before-restore of a restore that came to its end (one of
 * a restore that was killed is replaced); as store_open() and store_backup(). */
enum status store_restore(const char *path, const char *from, const struct store_key *key,
                          const char *actor, bool dry, struct store_restored *out,
                          struct errinfo *e);

#endif
