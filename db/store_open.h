/* store_open.h -- a store: opened, made, upgraded, closed. */
#ifndef DB_STORE_OPEN_H
#define DB_STORE_OPEN_H
#include "store_types.h"

/* store_open(path, mode, key, out, e): ST_ENOTFOUND when there is no such file.  key: NULL
 * for {.make = VAULT_FILE}.  A key's file that is missing is made with a new database.
 * ST_EDENIED: not the database's key; or the database is plaintext and key->plaintext does not
 * say so: with access to the file alone another one could be put in its place.  While the store
 * is open, a key record that its key has not authenticated is ST_EREFUSED, for good.
 * ST_EVERSION: of another version than this program's; STORE_MIGRATE upgrades an older one in
 * one transaction, of which a verified copy is kept: PATH.v1.bak for version 1. */
enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out,
                       struct errinfo *e);
void store_close(struct store *s); /* NULL is allowed */

/* store_kind(path, kind, e): how the database's master key is kept, which takes no key; also of
 * an older version.
 * store_look(path, out, e): how old a database is, and how large, which takes no key. */
enum status store_kind(const char *path, enum vault_kind *kind, struct errinfo *e);
enum status store_look(const char *path, struct store_look *out, struct errinfo *e);

/* store_in_use(path, pid): has another process the database open?  *pid: one that has, 0 where
 * that is not known.  Not while this process has it open. */
bool store_in_use(const char *path, int64_t *pid);

/* store_use_model(s, m): what is enrolled and calibrated from now on is by this model, which
 * the callers' face_work must be for too.  m is borrowed; NULL, as after store_open():
 * model_default.  Before other threads use s.
 * store_made_by(s): face_engine() of it, s's own. */
void store_use_model(struct store *s, const struct model *m);
const struct model *store_model(const struct store *s);
const char *store_made_by(const struct store *s);

/* store_ready(s, e): can the database be reached, and is its schema this program's?
 * ST_EREFUSED: it is not the one that was opened, or its master key was changed since, and the
 * new one is not known here.
 * store_refused(s, e): has a call found that it is not the one that was opened?  Then every other
 * one fails with ST_EREFUSED until the store is opened again, and e says why. */
enum status store_ready(struct store *s, struct errinfo *e);
bool store_refused(struct store *s, struct errinfo *e);

/* store_stats(s, out, e): counts and sizes.
 * store_vacuum(s, e): rewrite the database without the room that deleted rows left, while
 * others read it; writers wait, up to 5 s. */
enum status store_stats(struct store *s, struct store_stats *out, struct errinfo *e);
enum status store_vacuum(struct store *s, struct errinfo *e);

#endif
