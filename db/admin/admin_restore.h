/* admin_restore.h -- backup, move, restore, and acceptance of the present state of a database.  Only
 * admin_backup() and admin_move() may run beside a daemon. */
#ifndef DB_ADMIN_RESTORE_H
#define DB_ADMIN_RESTORE_H
#include "admin_check.h"
#include "log_entry.h"

/* admin_backup(s, path, key, out, e): Copies the state of one moment to the file path, while other processes
 * write.  The backup is complete or absent, and readable only by its owner.  Before it gets its name it
 * is verified: pages, rows, both logs, every template decrypted.  It replaces an older backup at path.
 *   key  the key of s, with its path
 *   out  receives the counts of the backup
 * Returns ST_OK; ST_EEXISTS: path is a file that is no backup; ST_ECORRUPT: *e names the damage of s. */
enum status admin_backup(struct store *s, const char *path, const struct store_key *key,
                         struct admin_copied *out, struct errinfo *e);

/* admin_move(s, path, key, found, e): Copies s, under the same key, to a new file or an empty database of a
 * server.  The copy has the same rows with the same MACs, therefore the same digest, and the same logs,
 * which its changes continue.  The copy is verified, and complete or absent.  s is not changed.
 *   key    the key of s, with its path
 *   found  receives the counts of the copy
 * Returns ST_OK; ST_EEXISTS: the target is not empty; ST_EREFUSED, ST_ECORRUPT: s is not authentic. */
enum status admin_move(struct store *s, const char *path, const struct store_key *key,
                       struct admin_copied *found, struct errinfo *e);

struct admin_restored {
    struct admin_copied
        backup;     /* counts of the backup, before the erasures are repeated */
    bool already;   /* an earlier call has restored it, and nothing has changed since */
    bool was_there; /* a database was replaced, and is kept as PATH.before-restore */
    uint64_t had_subjects, had_templates; /* counts of the replaced database */
    uint64_t lost;   /* subjects of the replaced database that the backup does not have */
    uint64_t erased; /* subjects of the backup that were erased since, and erased again */
    /* Tokens of the backup that were revoked or rotated since, and devices that were removed since:
     * revoked and removed again. */
    uint64_t revoked;
    uint64_t missed; /* change that the anchor names, and both databases lack; 0: none */
};

/* admin_restore(path, from, key, from_key, actor, dry, out, e): Verifies the backup from, and puts it in the
 * place of the database path, which is kept as PATH.before-restore.
 * From the change log of the replaced database it repeats the erasures since the backup, and revokes
 * the tokens that were revoked or rotated since: the backup has their old secrets.  This log must be
 * authentic, and continue the log of the backup.  Nothing else of the replaced database is used.
 * The anchor is created again.  If it named a later change than both databases have, the erasures and
 * revocations of this change and others are unknown: *out and the entry of the restore state this.
 * If the call is interrupted, path is the old or the restored database, and opens in either case; a
 * further call completes it.
 *   path      may be missing
 *   key       of the restored database, with its path
 *   from_key  file of the backup's key; NULL: key opens the backup too
 *   dry       only set *out
 *   out       already: there was nothing left to do
 * Returns ST_OK, or:
 *   ST_EBUSY       another process has the database open, or a rekey of it was interrupted
 *   ST_EMISMATCH   neither log continues the other
 *   ST_EDENIED     the backup has another key
 *   ST_EREFUSED    the log of the present database is not authentic
 *   ST_EEXISTS     there is a PATH.before-restore
 *   ST_EUNSYNCED   restored, but perhaps not durable
 *   or as admin_open(). */
enum status admin_restore(const char *path, const char *from, const struct store_key *key,
                          const char *from_key, const char *actor, bool dry,
                          struct admin_restored *out, struct errinfo *e);

/* The changes of a later, lost state of a database, from its signed log. */
struct admin_later {
    struct log_end after; /* end of the log of the restored database */
    /* Changes [n] after this end for which admin_again_is() is true. */
    const struct log_entry *change;
    size_t n; /* number of changes */
};

/* admin_again_is(c): Returns true if c is a change that has to be repeated after a restore: an erasure, a
 * revocation, a rotation, a removed device. */
bool admin_again_is(const struct log_entry *c);

/* admin_again(path, key, actor, later, dry, out, e): Repeats the erasures, revocations and removals of *later
 * in a database that its server has restored.  Appends a change of kind "restore", and recreates the
 * anchor.  Sets the counts erased and revoked of *out.
 * ST_EBUSY: another process has the database open, or its log does not end at later->after. */
enum status admin_again(const char *path, const struct store_key *key, const char *actor,
                        const struct admin_later *later, bool dry,
                        struct admin_restored *out, struct errinfo *e);

/* admin_again_done(path, key, dry): Returns true if the newest change was made by admin_again() and the anchor
 * agrees: an earlier call was interrupted after its commit, and nothing is left to do.  Unless dry is
 * set, renames the part of an anchor to its name. */
bool admin_again_done(const char *path, const struct store_key *key, bool dry);

struct admin_accepted {
    bool differed;    /* the rows did not match the last change */
    uint64_t removed; /* number of removed rows: not authentic, or without a subject */
};

/* admin_accept(path, key, actor, dry, report, arg, out, e): Accepts the present state of the database as the
 * newest, against its anchor and its digest.  Discards every later change, erasures included.  Removes
 * rows that are not authentic, and templates without a subject; rebuilds the indexes; appends a change
 * of kind "accept_state".  Calls report() once for each problem.
 *   dry  only report and set *out
 * Returns ST_OK; ST_ECORRUPT: the log has no authentic end, or two rows have one id: restore a backup;
 * or as store_open(). */
enum status admin_accept(const char *path, const struct store_key *key, const char *actor,
                         bool dry, store_report *report, void *arg,
                         struct admin_accepted *out, struct errinfo *e);

#endif
