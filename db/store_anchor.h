/* store_anchor.h -- an open store and the anchor of its database (anchor.h): asked when the
 * database is opened, and told after each durable change. */
#ifndef DB_STORE_ANCHOR_H
#define DB_STORE_ANCHOR_H
#include <stdatomic.h>
#include "anchor.h"
#include "errinfo.h"
#include "store_types.h"

struct sql_txn; /* sql.h */

struct store_anchor {
    char *path;           /* NULL: the store is of a copy, which has none */
    int serving;          /* anchor_serve(), or -1 */
    _Atomic uint64_t seq; /* that was told last */
    atomic_flag failed;
    atomic_bool fault; /* why is written */
    struct errinfo why;
};

/* store_anchor_init(a, key, path, db, e): its place: key->anchor; or PATH.anchor beside the key's
 * file, path; or, where that folder is a service's credentials or cannot be written, where it is
 * for a key beside the database, DB.key.anchor.  One that is there wins.  store_anchor_free(a) in
 * any case. */
enum status store_anchor_init(struct store_anchor *a, const struct store_key *key,
                              const char *path, const char *db, struct errinfo *e);
void store_anchor_free(struct store_anchor *a);

/* store_anchor_end(t, v, end, e): the ends of the chains as the transaction sees them, under the
 * vault v.
 * store_anchor_agrees(t, v, said, end, yes, e): has the database what its anchor said?
 * *end as above.
 * store_anchor_ask(a, v, db, said, e): what the anchor of the database db says; ST_EREFUSED: it is
 * missing or not its own.  Before the transaction that is held against it begins: others go on.
 * store_anchor_check(a, t, v, db, said, settle, e): ST_EREFUSED: it says of a change that the
 * database does not have.  settle: what was announced was done, or not, and is announced no more.
 * store_anchor_tell(a, v, end): after a durable commit; what goes wrong is kept in a->why, since
 * the change was made. */
enum status store_anchor_end(struct sql_txn *t, const struct vault *v,
                             struct anchor_end *end, struct errinfo *e);
enum status store_anchor_agrees(struct sql_txn *t, const struct vault *v,
                                const struct anchor *said, struct anchor_end *end,
                                bool *yes, struct errinfo *e);
enum status store_anchor_ask(const struct store_anchor *a, const struct vault *v,
                             const char *db, struct anchor *said, struct errinfo *e);
enum status store_anchor_check(const struct store_anchor *a, struct sql_txn *t,
                               const struct vault *v, const char *db,
                               const struct anchor *said, bool settle, struct errinfo *e);
void store_anchor_tell(struct store_anchor *a, const struct vault *v,
                       const struct anchor_end *end);

#endif
