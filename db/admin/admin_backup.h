/* admin_backup.h -- verified copies of the database. */
#ifndef DB_ADMIN_BACKUP_H
#define DB_ADMIN_BACKUP_H
#include "store_open.h"

struct admin_copied { /* what is in a copy that was verified */
    uint64_t subjects, templates, events, bytes;
};

/* admin_backup(s, path, key, out, e): a copy of one moment while others write, whole or not
 * at all and readable by its owner alone.  Before it gets its name it is verified: pages, rows, both
 * logs, every template decrypted.  An older backup of that name is replaced; another file is not
 * (ST_EEXISTS).  key: as the store was opened by, with its path.  Of the database's other errors
 * ST_ECORRUPT: what is damaged in it.
 * admin_verify(path, key, found, e): the same of a copy that is there.
 * admin_verify_store(s, found, e): of an open store. */
enum status admin_backup(struct store *s, const char *path, const struct store_key *key,
                         struct admin_copied *out, struct errinfo *e);
enum status admin_verify(const char *path, const struct store_key *key,
                         struct admin_copied *found, struct errinfo *e);
enum status admin_verify_store(struct store *s, struct admin_copied *found,
                               struct errinfo *e);

#endif
