/* store_rekey.h -- another master key. */
#ifndef DB_STORE_REKEY_H
#define DB_STORE_REKEY_H
#include "store_types.h"

/* to->compromised: whoever had the database and its key until now can open nothing that is written
 * from then on, nor forge a row, a token or a signature: each subject gets a new key, and all of it
 * is encrypted again, in transactions of their own before the one that changes the keys
 * (store_renew.h); called again after an interruption it goes on there.
 * store_rekey(s, actor, to, e): every subject's key under another master key, in one
 * transaction; an event with it.  The new key lies in PATH.new, on the disk, before that is
 * committed and takes the place of PATH after: a program that opens the database finds it in
 * either, whatever happens in between.  A random key goes into PATH too; the file of an old key
 * that is not replaced is removed: it becomes PATH.new before the commit, because a plaintext
 * database is refused beside PATH.  What was plain before is rewritten (VACUUM).
 * ST_EEXISTS: there is PATH.new of a change that was not made, PATH.old, or a PATH that is not
 * this database's key and would be replaced or in the way; nothing was changed.  After ST_EIO
 * the text says what was. */
enum status store_rekey(struct store *s, const char *actor, const struct store_rekey *to,
                        struct errinfo *e);

#endif
