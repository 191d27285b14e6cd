/* admin_restore.h -- a backup, which may be made beside a daemon; a copy in another place or engine; a
 * backup in the place of the database; and a database as it is, taken for the newest. */
#ifndef DB_ADMIN_RESTORE_H
#define DB_ADMIN_RESTORE_H
#include "admin_check.h"
#include "log_entry.h"

/* admin_backup(s, path, key, out, e): a copy of one moment while others write, whole or not
 * at all and readable by its owner alone.  Before it gets its name it is verified: pages, rows, both
 * logs, every template decrypted.  An older backup of that name is replaced; another file is not
 * (ST_EEXISTS).  key: as the store was opened by, with its path.  Of the database's other errors
 * ST_ECORRUPT: what is damaged in it. */
enum status admin_backup(struct store *s, const char *path, const struct store_key *key,
                         struct admin_copied *out, struct errinfo *e);

/* admin_move(s, path, key, found, e): s as it is, under the same key, in a file that is not there yet
 * or an empty database of a server: the same rows with the same MACs, so the same digest, and the same
 * logs, which the copy goes on from.  Whole or not at all, and verified; s is not changed.  key: as s
 * was opened by, with its path.  ST_EEXISTS: there is something; ST_EREFUSED, ST_ECORRUPT: s is not as
 * it was written. */
enum status admin_move(struct store *s, const char *path, const struct store_key *key,
                       struct admin_copied *found, struct errinfo *e);

struct admin_restored {
    struct admin_copied
        backup;     /* as it was verified, before subjects were erased again */
    bool already;   /* an earlier call has restored it, and nothing has changed since */
    bool was_there; /* there was a database, and it is PATH.before-restore */
    uint64_t had_subjects, had_templates; /* their numbers */
    uint64_t lost;   /* subjects of it that the backup does not have */
    uint64_t erased; /* subjects of the backup that were erased since */
    uint64_t
        revoked; /* tokens of the backup that were revoked or rotated since, and devices
                         that were removed: revoked and removed again */
    uint64_t
        missed; /* a change that the anchor names, and neither of the two has; or 0 */
};

/* admin_restore(path, from, key, from_key, actor, dry, out, e): the backup, verified, in the place
 * of the database, which is kept as PATH.before-restore; or with dry nothing but *out.  Of the
 * database that is there only what its change log proves, where that is verified and goes on from
 * the backup's: who was erased since is erased again, and tokens that were revoked or rotated since
 * are revoked: the backup has their old secrets.  key: of the database afterwards, with its path;
 * from_key: NULL where that opens the backup too, else its file.  A database that is missing is made.
 * The anchor is made again.  Where it named a later change than both have, what that and others have
 * erased or revoked is not known: *out and the entry of the restore say so.
 *
 * If the call is interrupted, the database is the one before or the restored one, and opens in either
 * case; a further call completes it (out->already: there was nothing left to do).
 * ST_EBUSY: another process has the database open, or a rekey of it was interrupted; ST_EMISMATCH:
 * neither log goes on from the other; ST_EDENIED: the backup has another key; ST_EREFUSED: the log of
 * the database that is there is not as it was written; ST_EEXISTS: there is a PATH.before-restore;
 * ST_EUNSYNCED: restored, but perhaps not on the disk; as admin_open(). */
enum status admin_restore(const char *path, const char *from, const struct store_key *key,
                          const char *from_key, const char *actor, bool dry,
                          struct admin_restored *out, struct errinfo *e);

/* The changes of a later state of a database, which no longer exists, by its signed log. */
struct admin_later {
    struct log_end after; /* where the database's own log ends */
    const struct log_entry
        *change; /* [n] of those behind it for which admin_again_is() */
    size_t n;
};

/* admin_again_is(c): Returns true if the change takes something away that a restored database has
 * again: an erasure, a revocation, a rotation, a removed device. */
bool admin_again_is(const struct log_entry *c);

/* admin_again(path, key, actor, later, dry, out, e): For a database that its server has restored:
 * repeats the erasures, revocations and removals of `later`, appends a change of kind "restore", and
 * makes the anchor anew.  Sets the counts erased and revoked of *out.
 * ST_EBUSY: another process has it open, or its log does not end at later->after. */
enum status admin_again(const char *path, const struct store_key *key, const char *actor,
                        const struct admin_later *later, bool dry,
                        struct admin_restored *out, struct errinfo *e);

/* admin_again_done(path, key, dry): Returns true if the newest change is that of an admin_again() and the
 * anchor agrees: an earlier call was interrupted behind its commit, and nothing is left to do.  Unless
 * dry, the part of an anchor is given its name. */
bool admin_again_done(const char *path, const struct store_key *key, bool dry);

struct admin_accepted {
    bool differed;    /* the rows were not those of the last change */
    uint64_t removed; /* rows that were not authentic, or of no subject */
};

/* admin_accept(path, key, actor, dry, report, arg, out, e): the database as it is now is the newest,
 * whatever its anchor and its digest say: every later change is given up, erasures included.  Rows
 * that are not authentic are removed, and templates whose subject is not there; indexes are built
 * again, and a change of kind "accept_state" says so.  report() is called once a problem.  dry:
 * nothing else.  ST_ECORRUPT: the log has no authentic end, or two rows have one id: restore a
 * backup; as store_open(). */
enum status admin_accept(const char *path, const struct store_key *key, const char *actor,
                         bool dry, store_report *report, void *arg,
                         struct admin_accepted *out, struct errinfo *e);

#endif
