/* admin_join.h -- a further daemon on a database on a server. */
#ifndef DB_ADMIN_JOIN_H
#define DB_ADMIN_JOIN_H
#include <stdint.h>
#include "status.h"

struct errinfo;
struct store_key; /* store_open.h */

/* admin_join(path, key, actor, daemon, e): Gives a new daemon its number, and so an access log of its own, for which
 * it waits for no other daemon.  Verifies the whole change log and the rows.  Appends a change with the
 * number, and creates the daemon's anchor key->anchor with the same.  The anchor is prepared before the
 * commit: without a place for it no number is used.  Another call completes an interrupted one.
 *   daemon  receives the number
 * ST_EINVAL: the database is in a file, key->anchor is NULL, or the server's clock differs by more than
 * STORE_CLOCKS_MS; ST_EEXISTS: the anchor exists; ST_EREFUSED: the database is not as it was written;
 * ST_EFULL: LOG_DAEMONS have joined. */
enum status admin_join(const char *path, const struct store_key *key, const char *actor,
                       uint32_t *daemon, struct errinfo *e);

#endif
