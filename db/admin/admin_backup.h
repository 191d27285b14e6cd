/* admin_backup.h -- verified copies of the database, while others write it. */
#ifndef DB_ADMIN_BACKUP_H
#define DB_ADMIN_BACKUP_H
#include "admin_check.h"

/* admin_backup(s, path, key, out, e): a copy of one moment while others write, whole or not
 * at all and readable by its owner alone.  Before it gets its name it is verified: pages, rows, both
 * logs, every template decrypted.  An older backup of that name is replaced; another file is not
 * (ST_EEXISTS).  key: as the store was opened by, with its path.  Of the database's other errors
 * ST_ECORRUPT: what is damaged in it. */
enum status admin_backup(struct store *s, const char *path, const struct store_key *key,
                         struct admin_copied *out, struct errinfo *e);

#endif
