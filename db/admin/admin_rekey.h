/* admin_rekey.h -- every secret of a database made anew: master key, subjects' keys, and those that
 * find, authenticate and sign. */
#ifndef DB_ADMIN_REKEY_H
#define DB_ADMIN_REKEY_H
#include "store_open.h"

struct admin_rekey {
    enum crypt_kind kind; /* of the new master key */
    const struct crypt_file
        *given;   /* it, or the passphrase; NULL: a random key, or none */
    bool in_file; /* given is kept in the key's file, in place of the old */
    bool keep;    /* the old database and key stay, as PATH.before-rekey and KEY.old */
    bool weak;    /* a passphrase may have few characters */
};

/* admin_rekey(path, key, to, actor, e): a copy under new keys takes the database's place; the old
 * one and its key are overwritten and removed, unless to->keep.  The change log goes on, with a
 * change of kind "rekey".  Killed, it has not happened, or the database is under the new key, which
 * is then in KEY.new and found there; and the old database may be left as PATH.before-rekey.  key: with
 * its path.
 * ST_EBUSY: another process has the database open; ST_EEXISTS: there is a PATH.before-rekey or
 * KEY.old; ST_EREFUSED: it is not as it was written; as store_open(). */
enum status admin_rekey(const char *path, const struct store_key *key,
                        const struct admin_rekey *to, const char *actor,
                        struct errinfo *e);

#endif
