/* admin_rekey.h -- every secret of a database made anew: the master key, the subjects' keys, and those
 * that find, authenticate and sign. */
#ifndef DB_ADMIN_REKEY_H
#define DB_ADMIN_REKEY_H
#include "store_open.h"

struct admin_rekey {
    enum crypt_kind kind; /* kind of the new master key */
    const struct crypt_file
        *given;   /* the new key or passphrase; NULL: a random key, or none */
    bool in_file; /* given is kept in the key's file, in place of the old */
    bool keep;    /* the old database and key stay, as PATH.before-rekey and KEY.old */
    bool weak;    /* a passphrase may have few characters */
};

/* admin_rekey(path, key, to, actor, completed, e): Copies the database under new keys, verifies the
 * copy, and puts it in the database's place; the change log goes on with a change of kind "rekey".
 *
 * Order: KEY.new is made; the copy is written and verified; the anchor is prepared; the old database
 * gets a second name (PATH.before-rekey with to->keep, else PATH.discard), and the copy its name; KEY
 * becomes KEY.old, and KEY.new becomes KEY; the anchor gets its name; the database is opened by KEY and
 * read; then, without to->keep, KEY.old and PATH.discard are overwritten and removed.  All names are
 * beside the files that symbolic links lead to.
 *
 * If it is interrupted anywhere, the database opens by KEY or by KEY.new (store_open()).  The next call
 * completes it first.  If the completed rekey is the one that is asked for and is the newest change, the
 * call ends there and sets *completed.
 *   key            how the database is opened, with its path
 *   ST_EBUSY       another process has the database open
 *   ST_EEXISTS     a file is in the way: PATH.before-rekey, PATH.discard, KEY.old, a KEY.new of another
 *                  database, or a file at KEY that is not the database's key
 *   ST_EDENIED     as store_open(); or the old key's file may not be replaced and overwritten
 *   ST_EINVAL      the key's file is no regular file
 *   ST_EREFUSED    the database is not as it was written
 *   ST_EUNSYNCED   the key was changed, but perhaps not on the disk; nothing was removed */
enum status admin_rekey(const char *path, const struct store_key *key,
                        const struct admin_rekey *to, const char *actor, bool *completed,
                        struct errinfo *e);

enum admin_left {                     /* what a KEY.new is */
                  ADMIN_LEFT_NOTHING, /* there is none */
                  ADMIN_LEFT_KEY, /* the database's key: rekey was interrupted behind the swap */
                  ADMIN_LEFT_USELESS, /* KEY opens the database; KEY.new opens neither it nor one beside it */
                  ADMIN_LEFT_UNKNOWN /* neither: it may be the key of another database */
};

/* admin_rekey_left(path, key, out, e): Finds out what KEY.new is.  Any status but ST_OK proves nothing
 * about it: the database or a key cannot be read for now. */
enum status admin_rekey_left(const char *path, const struct store_key *key,
                             enum admin_left *out, struct errinfo *e);

#endif
