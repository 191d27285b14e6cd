/* store_serve.h -- a store that a daemon has open for long: what the anchor (store_anchor.h) says
 * of its starts and stops. */
#ifndef DB_STORE_SERVE_H
#define DB_STORE_SERVE_H
#include "store_types.h"

/* store_serve(s, e): from now on until store_close() a daemon serves the database.  If the last
 * one was killed, or lost power, or uses that were there at its clean stop are gone, an entry of
 * kind unclean_stop says what the anchor knew of, and what is there.
 * store_last_change(s, seq, hash, e): the last entry of the changes, for the daemon's log.
 * store_anchor_fault(s, e): could the anchor not be written?  e says why; changes go on. */
enum status store_serve(struct store *s, struct errinfo *e);
enum status store_last_change(struct store *s, uint64_t *seq, char hash[65],
                              struct errinfo *e);
bool store_anchor_fault(struct store *s, struct errinfo *e);

/* store_accept_rollback(path, key, actor, outcome, e): the database as it is now is the newest,
 * whatever its anchor says; an entry of kind accept_rollback has the outcome: what the anchor
 * said.  ST_EINVAL: the anchor agrees with it already; as store_open(). */
enum status store_accept_rollback(const char *path, const struct store_key *key,
                                  const char *actor, char outcome[STORE_NAME_MAX + 1],
                                  struct errinfo *e);

#endif
