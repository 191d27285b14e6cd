/* store_backup.h -- verified copies of the database. */
#ifndef DB_STORE_BACKUP_H
#define DB_STORE_BACKUP_H
#include "store_types.h"

/* store_backup(s, path, key, out, e): a copy of one moment while others write, whole or not
 * at all and readable by its owner alone.  Before it gets its name it is verified: pages,
 * every subject and template decrypted with its key, the end of the events.  An older backup of
 * that name is replaced; another file is not (ST_EEXISTS).  key: as the store was opened by,
 * with its path.  Of the database's other errors ST_ECORRUPT: what is damaged in it.
 * store_backup_verify(path, key, found, e): the same of a copy that is there. */
enum status store_backup(struct store *s, const char *path, const struct store_key *key,
                         struct store_copied *out, struct errinfo *e);
enum status store_backup_verify(const char *path, const struct store_key *key,
                                struct store_copied *found, struct errinfo *e);

#endif
