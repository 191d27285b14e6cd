/* admin_join.h -- another daemon joins those that share a database on a server. */
#ifndef DB_ADMIN_JOIN_H
#define DB_ADMIN_JOIN_H
#include <stdint.h>
#include "status.h"

struct errinfo;
struct store_key; /* store_open.h */

/* admin_join(path, key, actor, daemon, e): the whole change log and the rows are verified; a change says
 * which number the daemon has, and key->anchor, a new file, that and how far the log has come: the
 * daemon that is started with it has an access log of its own, and waits for no other.
 * The anchor is prepared before the change is committed: without a place for it no number is used.  A
 * further call completes one that was interrupted.
 * ST_EINVAL: the database is in a file, key->anchor is NULL, or the server's clock differs by more
 * than STORE_CLOCKS_MS; ST_EEXISTS: there is an anchor; ST_EREFUSED: what is there is not as it was
 * written; ST_EFULL: LOG_DAEMONS have joined. */
enum status admin_join(const char *path, const struct store_key *key, const char *actor,
                       uint32_t *daemon, struct errinfo *e);

#endif
